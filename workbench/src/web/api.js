// Requests to the server. A refusal has a list of problems, each with a code and, if known, a line.

/** Status of an answer to a browser without the cookie of this start of the server. */
export const UNAUTHORISED = 401;

/** Refused request, with the reasons. */
export class Refusal extends Error {
  constructor(status, problems) {
    super(problems.map((problem) => problem.message).join("\n"));
    this.status = status;
    this.problems = problems;
    /** Whether the connection is lost, which the notice below the header says. */
    this.isLost = status === 0 || status === UNAUTHORISED;
  }
}

/** Returns the refusal of a server that has ended. */
export const noAnswer = () => new Refusal(0, [{ code: "E-PAGE-SERVER", message: "the server does not answer; start `retarder serve` again" }]);

let session = null;

/** Calls this when the server does not answer (`E-PAGE-SERVER`) or does not know this browser. */
let onLost = () => {};

export function whenLost(act) {
  onLost = act;
}

async function request(method, path, body, signal) {
  const options = { method, signal, headers: {} };
  if (body instanceof Blob) options.body = body;
  else if (body !== undefined) {
    options.body = JSON.stringify(body);
    options.headers["content-type"] = "application/json";
  }
  let response, text;
  try {
    response = await fetch(`/api${path}`, options);
    // A server may also end within its answer.
    text = await response.text();
  } catch (error) {
    if (error.name === "AbortError") throw error;
    onLost("gone");
    throw noAnswer();
  }
  const isJson = (response.headers.get("content-type") ?? "").startsWith("application/json");
  const value = isJson ? JSON.parse(text) : text;
  if (response.ok) return value;
  if (response.status === UNAUTHORISED) onLost("restarted");
  throw new Refusal(response.status, value.problems ?? [{ code: `HTTP ${response.status}`, message: text }]);
}

/** Opens a session on a project; without one, on a copy of the project that was open last. */
export async function open(project) {
  const opened = await request("POST", "/sessions", { project });
  session = opened.session;
  return opened;
}

/** Requests the cookie of a server that was started again; returns whether `token` is the one of its address. */
export async function exchange(token) {
  const response = await fetch(`/?${new URLSearchParams({ token })}`);
  return response.ok;
}

/** Asks whether the server and the session are there: "there", "closed", "restarted" or "gone". */
export async function presence() {
  const asked = session;
  try {
    const { ok, status } = await fetch(`/api${inSession("/presence")}`);
    // The tab may have opened another project since.
    if (ok || asked !== session) return "there";
    return status === UNAUTHORISED ? "restarted" : "closed";
  } catch {
    return "gone";
  }
}

/** Ends the session's work. */
export function close() {
  if (session) navigator.sendBeacon(`/api/sessions/${session}/close`);
}

/** Ends the session's work unless this page is loaded again. */
export function leave() {
  if (session) navigator.sendBeacon(`/api/sessions/${session}/leave`);
}

const inSession = (path) => `/sessions/${session}${path}`;

export const get = (path, signal) => request("GET", inSession(path), undefined, signal);
export const post = (path, body) => request("POST", inSession(path), body ?? {});
export const put = (path, body) => request("PUT", inSession(path), body);
export const remove = (path) => request("DELETE", inSession(path));
export const examples = () => request("GET", "/examples");
export const effects = () => get("/effects");
export const address = (path) => `/api${inSession(path)}`;

/** Sends a file; the server names it by its content. */
export const upload = (file) => request("POST", inSession(`/logs?${new URLSearchParams({ name: file.name })}`), file);

/**
 * Follows a job to its end. `onProgress` gets the completed share (0 to 1), the stage if the job has stages, and the
 * error of the model if the stage reports one.
 * Aborting the signal ends the job.
 */
export function follow(job, onProgress, signal) {
  return new Promise((resolve, reject) => {
    const events = new EventSource(address(`/jobs/${job}`));
    const end = (act) => { events.close(); act(); };
    const stop = () => end(() => {
      remove(`/jobs/${job}`).catch(() => {});
      reject(new DOMException("cancelled", "AbortError"));
    });
    signal?.addEventListener("abort", stop);
    if (signal?.aborted) stop();
    events.onerror = () => end(() => reject(new Refusal(0, [{ code: "E-PAGE-SERVER", message: "the server does not answer" }])));
    events.onmessage = (event) => {
      const progress = JSON.parse(event.data);
      if (progress.state === "running") onProgress(progress.share, progress.stage, progress.error);
      else if (progress.state === "done") end(resolve);
      else if (progress.state === "cancelled") end(() => reject(new DOMException("cancelled", "AbortError")));
      else end(() => reject(new Refusal(422, progress.problems)));
    };
  });
}
