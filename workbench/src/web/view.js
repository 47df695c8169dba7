// Displayed state, stored in the address after `#`, so that a link reproduces the view.

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

/** Reads the address, and calls `onMove` whenever the user changes it. */
export function begin(onMove) {
  listen = onMove;
  read();
  addEventListener("hashchange", () => { read(); listen(); });
}

export const page = () => state.page;

/** Returns a parameter of the view as text; null if it is not set. */
export const text = (name) => state.parameters.get(name);

/** Returns all values of a parameter, with any characters; empty if it is not set. */
export const texts = (name) => state.parameters.getAll(name);

/** Returns a parameter of the view as a number; null if it is not set or not a number. */
export function numberOf(name) {
  const value = parseFloat(state.parameters.get(name) ?? "");
  return Number.isFinite(value) ? value : null;
}

/** Changes the view; null or an empty list removes a parameter. */
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

/** Opens another page of the same project. */
export function go(page, changes = {}) {
  const project = state.parameters.get("project");
  state.page = page;
  state.parameters = new URLSearchParams(project ? { project } : {});
  set(changes);
  listen();
}

/** Returns the address of the view, without secrets. */
export const link = () => location.href;
