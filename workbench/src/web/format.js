// Formats of numbers and names.

/** Largest number of signals that the name of a file lists. */
const SIGNALS_MAX = 4;

/** Formats a number with this many significant digits, without an exponent if possible. */
export function number(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(digits - 1).replace("-", "−").replace("e−", "e-");
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(Math.min(decimals, 8)).replace("-", "−");
}

/** Formats a number for a narrow table: four digits, at most four of them after the point. */
export const brief = (value) => typeof value === "number" && Math.abs(value) < 1 ? String(+value.toFixed(4)).replace("-", "−") : number(value);

/** Formats a number with its sign. */
export const signed = (value, digits = 4) => (value > 0 ? "+" : "") + number(value, digits);

/** Formats a share in percent. */
export function percent(share) {
  if (share === null || share === undefined) return "–";
  const value = 100 * share;
  return `${(Math.abs(value) < 9.95 ? value.toFixed(1) : value.toFixed(0)).replace(/^-(?=0(\.0)?$)/, "").replace("-", "−")} %`;
}

/** Formats an interval of time in a suitable unit. */
export function duration(seconds) {
  if (seconds === null || seconds === undefined) return "–";
  if (seconds < 1) return `${number(1e3 * seconds, 3)} ms`;
  if (seconds < 600) return `${number(seconds, 4)} s`;
  return `${number(seconds / 60, 4)} min`;
}

/** Formats the rate of samples at this interval; empty if it is not known. */
export function rate(interval) {
  if (!interval) return "";
  return interval > 1e-3 ? `${number(1 / interval, 3)} Hz` : `${number(1e-3 / interval, 3)} kHz`;
}

/** Returns the rate of each signal of a log by name; empty if all signals have the same. */
export function ratesOf(summary) {
  const { signals, sample_interval_s: usual } = summary;
  if (!signals.some((signal) => signal.own_interval_s)) return new Map();
  return new Map(signals.map((signal) => [signal.name, rate(signal.own_interval_s ?? usual)]));
}

/** Returns the name of a file, without extension, from its parts: log, plant, signals. */
export function fileName(...parts) {
  const words = (part) => Array.isArray(part) && part.length > SIGNALS_MAX ? `${part.length} signals` : [part].flat().join(" ");
  return parts.map(words).map((part) => part.replace(/[^\p{L}\p{N}_+−]+/gu, "-").replace(/^-|-$/g, "")).filter(Boolean).join("_");
}

/** Formats a unit for display: m² for m2. */
export const unitText = (unit) => unit.replace(/(?<=[mA])[23]/g, (digit) => digit === "2" ? "²" : "³").replace("ohm", "Ω");

/** Formats a count in groups of three digits. */
export const count = (value) => value.toLocaleString("en").replaceAll(",", "\u202f");

// A map, because a log may name a signal like a property of an object.
const WORDS = new Map([
  ["p_ch", "chamber pressure"], ["i_fill", "current of the fill coil"], ["i_vent", "current of the vent coil"],
  ["duty_fill", "duty cycle of the fill valve"], ["duty_vent", "duty cycle of the vent valve"], ["u_bat", "supply voltage"],
  ["x_fill", "stroke of the fill valve"], ["x_vent", "stroke of the vent valve"], ["x_plunger", "stroke of the plunger"], ["x_actuator", "position of the actuator"], ["t_gas", "gas temperature"],
]);

/** Returns the label of a signal: words and name, or the name alone. */
export const titled = (name) => WORDS.has(name) ? `${WORDS.get(name)} ${name}` : name;
