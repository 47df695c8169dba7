// Elements without markup: whatever a log calls its signals is text.

/** An element with properties (`class`, `on`, `data`, ARIA and DOM properties) and children; texts become text nodes. */
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

/** Puts `children` in place of what `parent` has. */
export function fill(parent, ...children) {
  parent.replaceChildren(...children.flat(Infinity).filter((child) => child !== undefined && child !== null && child !== false));
}

/** A table of rows; the first cell of each row is its header. */
export function table(head, rows, caption) {
  return element("table", {},
    caption && element("caption", {}, caption),
    element("thead", {}, element("tr", {}, head.map((cell) => element("th", { scope: "col" }, cell)))),
    element("tbody", {}, rows.map((row) => element("tr", {},
      row.map((cell, index) => index === 0 ? element("th", { scope: "row" }, cell) : element("td", {}, cell))))));
}

/** A button. */
export function button(label, act, properties = {}) {
  return element("button", { type: "button", on: { click: act }, ...properties }, label);
}

/** Asks; the name of the answer, or none where a person thinks better of it. The first of `answers`, name by label, is proposed. */
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

/** Tells something above the page. A note goes by itself, what is lasting or a problem when it is closed, a problem with its page as well. */
export function tell(text, kind = "note") {
  const place = document.getElementById("messages");
  if ([...place.children].some((there) => there.firstChild?.textContent === text)) return;
  const id = `message-${++messages}`;
  const message = element("p", { class: `message ${kind}`, id }, text, button("×", () => message.remove(), { class: "close", "aria-label": "Close" }));
  place.append(message);
  if (kind === "note") setTimeout(() => message.remove(), 4000);
}

/** Takes away the problems that were told. */
export function forgetProblems() {
  for (const message of document.querySelectorAll("#messages .problem")) message.remove();
}

/** Tells all problems of a refusal. */
export function tellProblems(refusal, what) {
  for (const problem of refusal.problems ?? [{ message: String(refusal) }]) tell(`${what}: ${problem.message}`, "problem");
}
