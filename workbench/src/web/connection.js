// Connection to the server: a notice below the header says when it is lost, and restores it with the address of the new
// start.

import * as api from "./api.js";
import { button, element, fill } from "./dom.js";

/** Interval (ms) between two questions whether the server is there. */
const INTERVAL = 2000;

const WORDS = {
  gone: "The server does not answer. To continue, start `retarder serve` again and paste the address that it prints.",
  restarted: "The server was started again. To continue, paste the address that it printed.",
  closed: "The server closed this tab, because too many were open.",
};

/** Digits of a token. */
const TOKEN = /^[0-9a-f]{32}$/;

let state = "there";
let restore = async () => {};

const notice = () => document.getElementById("connection");

/** Watches the connection; `act` opens the project again after the server was started again. */
export function watch(act) {
  restore = act;
  api.whenLost(show);
  setInterval(() => { if (document.visibilityState === "visible") ask(); }, INTERVAL);
  document.addEventListener("visibilitychange", () => { if (document.visibilityState === "visible") ask(); });
}

async function ask() {
  const found = await api.presence();
  if (found === "there") hide();
  // The new address was opened in another tab, which gave this browser the cookie.
  else if (found === "closed" && (state === "gone" || state === "restarted")) await begin();
  else show(found);
}

async function begin() {
  hide();
  await restore();
}

function hide() {
  state = "there";
  notice().hidden = true;
}

function show(found) {
  if (state === found) return;
  state = found;
  const again = found === "closed"
    ? button("Open again", begin, { class: "primary", id: "reopen" })
    : addressField();
  fill(notice(), element("span", {}, WORDS[found]), again);
  notice().hidden = false;
}

/** Creates the field for the new address, which is used as soon as it is pasted. */
function addressField() {
  const problem = element("span", { class: "problem", role: "alert" });
  const field = element("input", { id: "new-address", "aria-label": "new address", placeholder: "address or token", autocomplete: "off", spellcheck: false });
  const send = async () => { problem.textContent = await reconnect(field.value.trim()); };
  field.addEventListener("input", () => { if (tokenIn(field.value.trim())) send(); });
  return [field, button("Reconnect", send, { class: "primary", id: "reconnect" }), problem];
}

/** Returns the token of an address, or the text itself if it is a token. */
function tokenIn(text) {
  const token = URL.canParse(text) ? new URL(text).searchParams.get("token") : text;
  return TOKEN.test(token ?? "") ? token : null;
}

/** Connects to the server of an address; returns why it could not. */
async function reconnect(text) {
  const token = tokenIn(text);
  if (!token) return "This is not an address that `retarder serve` prints.";
  const port = URL.canParse(text) ? new URL(text).port : location.port;
  if (port !== location.port) {
    // A server on another port is another origin; the page opens there with the same view.
    location.assign(Object.assign(new URL(location.href), { port, search: `?token=${token}` }));
    return "";
  }
  try {
    if (!await api.exchange(token)) return "This is not the address of the running server, or it was opened in another browser.";
  } catch {
    return "The server does not answer yet.";
  }
  await begin();
  return "";
}
