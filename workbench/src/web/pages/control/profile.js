// Reference profile as a table of steps and ramps.

import { button, element, fill, showMessage } from "../../dom.js";

/** Largest number of changes in the table; a longer profile is edited in its file. */
const ROWS_MAX = 60;
/** Largest number of changes for which the table is open initially. */
const SHORT = 8;

/** Creates a form that passes the edited profile to `apply`, or a file to `open`. Both refuse by throwing. */
export function profileForm(query, apply, open) {
  const { profile } = query;
  const field = (value, name, least, role = "short") => element("input", { type: "number", step: "any", min: least, value, class: role, "aria-label": name, required: true });
  const start = field(profile.start_bar, "reference at the start");
  const pressure = field(profile.start_pressure_bar, "pressure at the start", 0);
  const end = field(profile.end_s, "end of the profile", 0);
  const body = element("tbody");
  const row = (step) => {
    const line = element("tr", { class: "profile-step" },
      element("td", {}, field(step.time_s, "time of the change", 0, "cell")), element("td", {}, field(step.to_bar, "reference from then on", undefined, "cell")), element("td", {}, field(step.within_s, "duration of the ramp", 0, "cell")),
      element("td", {}, button("×", () => line.remove(), { "aria-label": "Remove this change", class: "link close" })));
    return line;
  };
  fill(body, profile.changes.slice(0, ROWS_MAX).map(row));
  const isWhole = profile.changes.length <= ROWS_MAX;
  const read = () => ({
    name: profile.name.replace(/(, edited)?$/, ", edited"), start_bar: Number(start.value), start_pressure_bar: Number(pressure.value), end_s: Number(end.value),
    changes: [...body.children].map((line) => {
      const [time, to, within] = line.querySelectorAll("input");
      return { time_s: Number(time.value), to_bar: Number(to.value), within_s: Number(within.value) };
    }).sort((a, b) => a.time_s - b.time_s),
  });
  const add = () => {
    const last = read().changes.at(-1) ?? { time_s: 0, to_bar: Number(start.value) };
    list.open = true;
    body.append(row({ time_s: +(last.time_s + 1).toFixed(3), to_bar: last.to_bar, within_s: 0 }));
    if (Number(end.value) < last.time_s + 2) end.value = +(last.time_s + 2).toFixed(3);
  };
  const file = element("input", { type: "file", id: "profile-file", accept: ".csv", on: { change: async () => {
    const [chosen] = file.files;
    if (!chosen) return;
    if (chosen.size > 1 << 20) { showMessage(`${chosen.name}: a profile has at most 1 MiB on this page`, "problem"); return; }
    await open({ name: chosen.name, csv: await chosen.text() }).catch(() => {});
  } } });
  const about = query.scenarios.find((one) => one.name === query.scenario)?.about ?? "";
  const list = element("details", { open: profile.changes.length <= SHORT },
    element("summary", {}, "Steps and ramps"),
    element("table", { class: "form" },
      element("thead", {}, element("tr", {}, [["time", "s"], ["reference", "bar gauge"], ["ramp", "s"]].map(([name, unit]) => element("th", { scope: "col" }, name, element("span", { class: "unit" }, unit))), element("th"))), body));
  const form = element("form", { class: "stack tight", id: "profile", on: { submit: (event) => { event.preventDefault(); apply(read()).catch(() => {}); } } },
    element("p", { class: "quiet" }, query.is_edited ? profile.name : `${about}. It runs on the plant of this project.`),
    element("label", {}, "reference at the start ", start, element("span", { class: "unit" }, " bar gauge")),
    element("label", {}, "pressure at the start ", pressure, element("span", { class: "unit" }, " bar gauge")),
    list,
    !isWhole && element("p", { class: "quiet" },
      `${profile.changes.length} changes (at most ${ROWS_MAX} in this table). Edit the profile in a file.`),
    element("label", {}, "end ", end, element("span", { class: "unit" }, " s")),
    element("div", { class: "row" },
      isWhole && button("Add a step", add, { id: "add-step" }),
      isWhole && element("button", { type: "submit", class: "primary", id: "apply-profile" }, "Apply and run"),
      query.is_edited && button("Reset", () => apply(null).catch(() => {})),
      element("label", { class: "button", for: "profile-file", title: "CSV with the columns time_s and p_ref_bar_gauge" }, "Open file …"), file));
  return [element("h2", {}, "Reference profile"), form];
}
