// One job: how it goes, its words, its surface and drawing, its files.
import { ask, at, element, ended, standing, verdictWords } from "./service.js";
import { readModel } from "./model.js";
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

/** A link to a file, with a place for its size. */
function fileItem(file) {
  const item = element("li"), link = element("a", file.name);
  link.href = file.href;
  link.title = file.description;
  item.append(link, element("span"));
  if (file.parameters.includes("version")) {
    const old = element("a", "R12");
    old.href = `${file.href}?version=r12`;
    old.title = `${file.description}, for old controllers`;
    item.append(" ", old);
  }
  if (file.part !== null) item.append(element("span", ` ${file.part}`, "quiet"));
  return item;
}

/** All forms as links at once, those of single parts when they are asked for. */
function showFiles(files) {
  const units = () => {
    for (const link of at("files").querySelectorAll("li a")) {
      const file = files.find((f) => link.pathname === f.href);
      if (!file?.parameters.includes("units")) continue;
      const address = new URL(link.href);
      if (at("units").value) address.searchParams.set("units", at("units").value);
      else address.searchParams.delete("units");
      link.href = address.href;
    }
  };
  const parts = files.filter((f) => f.part !== null);
  at("downloads").replaceChildren(...files.filter((f) => f.part === null).map(fileItem));
  at("parts").hidden = parts.length === 0;
  at("parts").firstElementChild.textContent = `Files of single parts (${parts.length})`;
  at("parts").ontoggle = () => {
    if (at("pieces").children.length === 0) at("pieces").replaceChildren(...parts.map(fileItem));
    units();
  };
  at("units").onchange = units;
  at("files").hidden = false;
}

/** Sizes one after the other, for a form is written when it is asked for. */
async function showSizes() {
  for (const item of [...at("downloads").children]) {
    const answer = await fetch(item.firstChild.href, { method: "HEAD" });
    const kilobytes = Number(answer.headers.get("Content-Length")) / 1000;
    if (answer.ok) item.children[1].textContent = ` ${kilobytes.toFixed(kilobytes < 10 ? 1 : 0)} kB`;
  }
}

/** Three digits, with the unit. */
const measure = (value, unit) => `${Number(value.toPrecision(3))}${unit === "deg" ? "°" : ` ${unit}`}`;

async function showSpace(href) {
  const answer = await fetch(href);
  if (!answer.ok) return;
  const model = readModel(await answer.arrayBuffer());
  const { quantity, unit, limit, largest, units } = model.meaning;
  const name = (quantity ?? "").replaceAll("_", " ");
  at("space").hidden = false;
  // Without a limit the colours end at the largest, which is not above itself.
  const viewer = new Viewer(at("canvas"), model, limit || largest * (1 + 1e-5) || 1);
  at("rulings").hidden = model.lines.length === 0;
  at("legend").hidden = !quantity;
  at("quantity").textContent = `${name} 0`;
  at("limit").textContent = limit ? `limit ${measure(limit, unit)}, largest ${measure(largest, unit)}` : `largest ${measure(largest, unit ?? "")}`;
  paintScale(at("scale"), Boolean(limit));
  at("lines").onchange = () => { viewer.showsLines = at("lines").checked; viewer.draw(); };
  at("home").onclick = () => viewer.home();
  const help = at("under").textContent;
  viewer.onPoint = (hit) => {
    at("under").textContent = hit
      ? `${hit.name} at ${hit.place.map((x) => x.toPrecision(5)).join(", ")} ${units}${Number.isNaN(hit.value) ? "" : `: ${name} ${measure(hit.value, unit)}`}`
      : help;
  };
}

async function showResult(job) {
  const [result, list] = await Promise.all([ask(`${path}/result`), ask(job.links.artifacts)]);
  at("summary").replaceChildren(...result.summary.map((s) => element("li", s)));
  showFiles(list.items);
  const whole = (form) => list.items.find((f) => f.name === `result.${form}`)?.href;
  at("pictures").hidden = false;
  at("drawing").hidden = !whole("svg");
  at("picture").onerror = () => { at("drawing").hidden = true; };
  if (whole("svg")) at("picture").src = at("sheet").href = whole("svg");
  if (whole("glb")) await showSpace(whole("glb"));
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
