// Elements without markup: names from a log are always text.

/**
 * Creates an element with properties (`class`, `on`, `data`, ARIA and DOM properties) and children; texts become text
 * nodes.
 */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name === "class") made.className = value;
    else if (name === "on") for (const [event, act] of Object.entries(value)) made.addEventListener(event, act);
    else if (name === "data") Object.assign(made.dataset, value);
    else if (name === "style") Object.assign(made.style, value);
    else if (name.startsWith("aria-") || name === "for" || name === "role" || name === "colspan" || name === "list") made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children.flat(Infinity).filter((child) => child !== undefined && child !== null && child !== false));
  return made;
}

/** Replaces the children of `parent` by `children`. */
export function fill(parent, ...children) {
  parent.replaceChildren(...children.flat(Infinity).filter((child) => child !== undefined && child !== null && child !== false));
}

/** Creates a table of rows; the first cell of each row is its header. */
export function table(head, rows, classes) {
  return element("table", { class: classes },
    element("thead", {}, element("tr", {}, head.map((cell) => element("th", { scope: "col" }, cell)))),
    element("tbody", {}, rows.map((row) => element("tr", {},
      row.map((cell, index) => index === 0 ? element("th", { scope: "row" }, cell) : element("td", {}, cell))))));
}

/** Lets keys scroll a part that is wider than its place: only then it takes the focus. */
const overflows = new ResizeObserver((parts) => {
  for (const { target } of parts) {
    if (target.scrollWidth > target.clientWidth) target.tabIndex = 0;
    else target.removeAttribute("tabindex");
  }
});

/** Creates a part that scrolls sideways where its children are wider, with a name for screen readers. */
export function scrolling(label, ...children) {
  const part = element("div", { class: "scroll", role: "region", "aria-label": label }, ...children);
  overflows.observe(part);
  return part;
}

/** Creates a button. */
export function button(label, act, properties = {}) {
  return element("button", { type: "button", on: { click: act }, ...properties }, label);
}

/**
 * Asks a question, and returns the name of the answer, or nothing if the user cancels. The first of `answers` (name by
 * label) is the default.
 */
export function ask(question, answers) {
  return new Promise((resolve) => {
    const end = (answer) => { dialog.close(); dialog.remove(); resolve(answer); };
    const dialog = element("dialog", { "aria-label": question },
      element("p", {}, question),
      element("p", { class: "row" },
        Object.entries(answers).map(([name, label], index) => button(label, () => end(name), { class: index === 0 ? "primary" : undefined, id: name })),
        button("Cancel", () => end(null))));
    dialog.addEventListener("cancel", (event) => { event.preventDefault(); end(null); });
    document.body.append(dialog);
    dialog.showModal();
  });
}

/** Saves bytes or text under a name. */
export function save(name, url) {
  const link = element("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}

let messages = 0;

/**
 * Shows a message above the page. A note disappears by itself, a lasting message or a problem when it is closed; a
 * problem also disappears with its page.
 */
export function showMessage(text, kind = "note") {
  const place = document.getElementById("messages");
  if ([...place.children].some((there) => there.firstChild?.textContent === text)) return;
  const id = `message-${++messages}`;
  const message = element("p", { class: `message ${kind}`, id }, text, button("×", () => message.remove(), { class: "close", "aria-label": "Close" }));
  place.append(message);
  if (kind === "note") setTimeout(() => message.remove(), 4000);
}

/** Removes the problems above the page. */
export function forgetProblems() {
  for (const message of document.querySelectorAll("#messages .problem")) message.remove();
}

/** Shows all problems of a refusal, except that of a lost connection, which has its own notice. */
export function showProblems(refusal, what) {
  if (refusal.isLost) return;
  for (const problem of refusal.problems ?? [{ message: String(refusal) }]) showMessage(`${what}: ${problem.message}`, "problem");
}
