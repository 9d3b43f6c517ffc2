// Asking the service, and small helpers of both pages.

/** The element of that id. @param {string} id @returns {any} */
export const at = (id) => document.getElementById(id);

/** An element with a text and a class. @param {string} tag @param {string} [text] @param {string} [kind] */
export function element(tag, text = "", kind = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

/**
 * What the service says at a path; an error carries its sentence.
 * @param {string} path @param {RequestInit} [init] @returns {Promise<any>}
 */
export async function ask(path, init) {
  const answer = await fetch(path, init);
  const text = await answer.text();
  let said = null;
  try { said = text ? JSON.parse(text) : null; } catch { /* not the service: a proxy */ }
  if (!answer.ok) throw new Error(said?.detail ?? `the service answered ${answer.status}`);
  return said;
}

/** Whether a job has come to its end. @param {any} job */
export const ended = (job) => !["accepted", "running"].includes(job.status);

/** Where a job stands, in words. @param {any} job */
export function standing(job) {
  if (job.cancel_requested && !ended(job)) return "cancelling";
  return job.status === "running" ? `running: ${job.phase}, ${Math.round(job.progress)} %` : job.status;
}

/** A verdict in words. @param {string} [verdict] */
export const verdictWords = (verdict) => (verdict ?? "").replace("_", " ");

/** Time since, in the largest whole unit. @param {string} time */
export function age(time) {
  const seconds = Math.max(0, (Date.now() - Date.parse(time)) / 1000);
  for (const [unit, length] of [["d", 86400], ["h", 3600], ["min", 60]]) {
    if (seconds >= length) return `${Math.floor(seconds / length)} ${unit}`;
  }
  return `${Math.floor(seconds)} s`;
}
