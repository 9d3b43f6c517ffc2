// One job: how it goes, its words, its surface and drawing, its files.
import { ask, at, element, ended, standing, verdictWords } from "./service.js";
import { readModel, readRulings } from "./model.js";
import { Viewer, paintScale } from "./viewer.js";

const id = location.pathname.split("/")[2];
const path = `/v1/jobs/${id}`;
/** How often a job that is under way is asked for, ms. */
const BEAT = 500;
const pause = () => new Promise((done) => setTimeout(done, BEAT));

async function follow() {
  let job;
  while (!ended(job = await ask(path))) {
    show(job);
    await pause();
  }
  show(job);
  return job;
}

function show(job) {
  document.title = `${job.label ?? job.method} – mouldloft`;
  at("title").textContent = job.label ?? job.method;
  at("facts").textContent = [job.method, `job ${job.id}`, `accepted ${job.created}`,
    job.solve_ms === null || job.solve_ms === undefined ? "" : `fitted in ${Math.round(job.solve_ms)} ms`,
    `version ${job.engine_version}`].filter(Boolean).join(" · ");
  const words = [standing(job), verdictWords(job.verdict)].filter(Boolean).join(": ");
  if (at("state").textContent !== words) at("state").textContent = words;
  at("state").className = job.verdict === "within_limits" ? "good" : job.verdict || job.status === "failed" ? "bad" : "";
  at("progress").hidden = at("cancel").hidden = ended(job);
  at("progress").value = job.progress;
  at("warnings").replaceChildren(...job.warnings.map((w) => element("li", w)));
}

function showTrouble(error) {
  at("trouble").hidden = false;
  at("detail").textContent = `${error.detail} (${error.code}${error.reference ? `, reference ${error.reference}` : ""})`;
  at("errors").replaceChildren(...(error.errors ?? []).map((e) =>
    element("li", [e.pointer, e.message, e.hint].filter(Boolean).join(" – "))));
}

/** A file's text, or none where this result has no such form. */
async function text(form) {
  const answer = await fetch(`${path}/result.${form}`);
  return answer.ok ? answer.text() : "";
}

/** All forms as links at once. */
function showFiles(forms) {
  at("downloads").replaceChildren(...forms.map((form) => {
    const item = element("li"), link = element("a", `result.${form}`);
    link.href = `${path}/result.${form}`;
    item.append(link, element("span"));
    return item;
  }));
  at("files").hidden = false;
}

/** Sizes one after the other, for a form is written when it is asked for. */
async function showSizes() {
  for (const item of [...at("downloads").children]) {
    const answer = await fetch(item.firstChild.href, { method: "HEAD" });
    const kilobytes = Number(answer.headers.get("Content-Length")) / 1000;
    if (answer.ok) item.lastChild.textContent = ` ${kilobytes.toFixed(kilobytes < 10 ? 1 : 0)} kB`;
    else if (answer.status === 404) item.remove();
  }
}

async function showSpace(limit) {
  const [mesh, table] = await Promise.all([text("obj"), text("csv")]);
  if (!mesh) return;
  const model = readModel(mesh, readRulings(table));
  at("space").hidden = false;
  const viewer = new Viewer(at("canvas"), model, limit || 1);
  const coloured = model.lines.length > 0 && limit > 0;
  at("rulings").hidden = model.lines.length === 0;
  at("legend").hidden = !coloured;
  at("limit").textContent = `above the limit of ${limit}° (twist)`;
  paintScale(at("scale"));
  at("lines").onchange = () => { viewer.showsLines = at("lines").checked; viewer.draw(); };
  at("home").onclick = () => viewer.home();
  const help = at("under").textContent;
  viewer.onPoint = (hit) => {
    at("under").textContent = hit
      ? `${hit.name} at ${hit.place.map((x) => x.toPrecision(5)).join(", ")}${hit.value >= 0 && coloured ? `: twist ${hit.value.toFixed(2)}°` : ""}`
      : help;
  };
}

async function showResult(job) {
  const [result, methods] = await Promise.all([ask(`${path}/result`), ask(`/v1/methods/${job.method}`)]);
  at("summary").replaceChildren(...result.summary.map((s) => element("li", s)));
  const forms = methods.formats;
  showFiles(forms);
  at("pictures").hidden = false;
  at("drawing").hidden = !forms.includes("svg");
  at("picture").onerror = () => { at("drawing").hidden = true; };
  if (forms.includes("svg")) at("picture").src = at("sheet").href = `${path}/result.svg`;
  // A curve has no mesh though its method has the form.
  if (forms.includes("obj") && result.surfaces.length > 0) await showSpace(result.method_specific.options?.max_twist_deg ?? 0);
  await showSizes();
}

function showCurl() {
  const base = location.origin;
  const lines = [`curl -s ${base}${path}/input -o job.json`,
    `curl -s '${base}/v1/jobs?wait=55' -H 'Content-Type: application/json' --data-binary @job.json`,
    `curl -s ${base}/v1/jobs/ID/result -o result.json`];
  at("curl").textContent = lines.join("\n");
  at("copy").onclick = async () => {
    try {
      await navigator.clipboard.writeText(lines.join("\n"));
      at("copy").textContent = "Copied";
    } catch {
      // Only pages over TLS or of this machine may write the clipboard.
      getSelection()?.selectAllChildren(at("curl"));
      at("copy").textContent = "Selected: copy it by key";
    }
  };
}

showCurl();
at("cancel").onclick = () => ask(`${path}/cancel`, { method: "POST" }).catch((e) => { at("state").textContent = e.message; });
try {
  const job = await follow();
  if (job.error) showTrouble(job.error);
  if (job.status === "successful") await showResult(job);
} catch (error) {
  at("trouble").hidden = false;
  at("trouble").querySelector("h3").textContent = "Something is missing";
  at("detail").textContent = String(error.message);
}
