// Displayed state, stored in the address after `#`, so that a link reproduces the view. A change of page or log is an
// entry of the browser's history; a change of zoom is not.

const state = { page: "logs", parameters: new URLSearchParams() };
/** Parameters of each page as it was left. */
const left = new Map();
let listen = () => {};

function read() {
  const [page, query] = location.hash.replace(/^#\/?/, "").split("?");
  state.page = page || "logs";
  state.parameters = new URLSearchParams(query ?? "");
}

function address() {
  const query = state.parameters.toString();
  return `#/${state.page}${query ? `?${query}` : ""}`;
}

/** Changes parameters; null or an empty list removes one. */
function change(changes) {
  for (const [name, value] of Object.entries(changes)) {
    state.parameters.delete(name);
    for (const one of [value].flat()) {
      if (one === null || one === undefined || one === "") continue;
      state.parameters.append(name, typeof one === "number" ? String(+one.toPrecision(12)) : one);
    }
  }
}

/** Reads the address, and calls `onMove` whenever the user goes to another page, also by Back and Forward. */
export function begin(onMove) {
  listen = onMove;
  read();
  addEventListener("popstate", () => { keep(); read(); listen(); });
}

function keep() {
  left.set(state.page, state.parameters);
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

/** Changes the view of this page; null or an empty list removes a parameter. */
export function set(changes) {
  change(changes);
  history.replaceState(null, "", address());
}

/** Opens another page of the same project, as it was left if that view has all of `changes`. */
export function go(page, changes = {}) {
  keep();
  const project = state.parameters.get("project");
  const before = left.get(page);
  const isSame = before && Object.entries(changes).every(([name, value]) => before.get(name) === String(value));
  state.page = page;
  state.parameters = new URLSearchParams(isSame ? before : project ? { project } : {});
  change(changes);
  history.pushState(null, "", address());
  listen();
}

/** Forgets the views of all pages, for another project or other logs. */
export function forget() {
  left.clear();
}

/** Returns the address of the view, without secrets. */
export const link = () => location.href;
