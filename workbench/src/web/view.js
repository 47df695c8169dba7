// What is shown, as the part of the address behind `#`: a link is a view.

const state = { page: "logs", parameters: new URLSearchParams() };
let listen = () => {};

function read() {
  const [page, query] = location.hash.replace(/^#\/?/, "").split("?");
  state.page = page || "logs";
  state.parameters = new URLSearchParams(query ?? "");
}

function write() {
  const query = state.parameters.toString();
  history.replaceState(null, "", `#/${state.page}${query ? `?${query}` : ""}`);
}

/** Reads the address, and calls `onMove` whenever a person goes elsewhere in it. */
export function begin(onMove) {
  listen = onMove;
  read();
  addEventListener("hashchange", () => { read(); listen(); });
}

export const page = () => state.page;

/** A text of the view; none if it does not say. */
export const text = (name) => state.parameters.get(name);

/** A list of texts of the view, whatever letters they have; empty if it does not say. */
export const texts = (name) => state.parameters.getAll(name);

/** A number of the view; none if it does not say, or is no number. */
export function numberOf(name) {
  const value = parseFloat(state.parameters.get(name) ?? "");
  return Number.isFinite(value) ? value : null;
}

/** Changes the view; null takes a part away, and so does an empty list. */
export function set(changes) {
  for (const [name, value] of Object.entries(changes)) {
    state.parameters.delete(name);
    for (const one of [value].flat()) {
      if (one === null || one === undefined || one === "") continue;
      state.parameters.append(name, typeof one === "number" ? String(+one.toPrecision(12)) : one);
    }
  }
  write();
}

/** Goes to another page; the project stays. */
export function go(page, changes = {}) {
  const project = state.parameters.get("project");
  state.page = page;
  state.parameters = new URLSearchParams(project ? { project } : {});
  set(changes);
  listen();
}

/** The address of the view, without secrets. */
export const link = () => location.href;
