// Long job as its page sees it: the page begins it, and follows it again when it is shown again.

import * as jobs from "../jobs.js";

export class Work {
  /** Creates the work of a page; its jobs begin at one of the `paths`. */
  constructor(what, ...paths) {
    Object.assign(this, { what, paths, job: null, isLeft: false });
  }

  /** Begins a job by a request, and follows it; returns whether it was completed while the page is shown. */
  run(path, request) {
    return this.follow(jobs.begin(this.what, path, request));
  }

  /** Returns whether a job of this page runs. */
  get isRunning() {
    return jobs.runningAt(this.paths) !== null;
  }

  /** Follows the running job of this page, which was begun when it was shown before. */
  resume() {
    return this.follow(jobs.runningAt(this.paths));
  }

  async follow(job) {
    if (!job) return false;
    this.job = job;
    job.watchers += 1;
    const isDone = await job.ended;
    this.job = null;
    return isDone && !this.isLeft;
  }

  /** Leaves the job running. */
  leave() {
    this.isLeft = true;
    if (this.job) this.job.watchers -= 1;
  }
}
