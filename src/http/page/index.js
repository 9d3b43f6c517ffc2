// The list of jobs: submit an example, filter, follow, cancel.
import { age, ask, at, element, ended, standing, verdictWords } from "./service.js";

/** How often jobs that are under way are asked for, ms. */
const BEAT = 1000;
let examples = [];
let limit = 50;
let timer = 0;
let asked = 0;

function tell(words) { at("news").textContent = words; }

function row(job) {
  const line = element("tr");
  const label = element("td");
  const link = element("a", job.label ?? job.id);
  link.href = job.links.view;
  label.append(link);
  const verdict = element("td", verdictWords(job.verdict), job.verdict === "within_limits" ? "good" : "bad");
  const since = element("td", age(job.created));
  since.title = job.created;
  const actions = element("td");
  if (!ended(job) && !job.cancel_requested) {
    const cancel = element("button", "Cancel");
    cancel.setAttribute("aria-label", `Cancel ${job.label ?? job.id}`);
    cancel.onclick = () => attempt(async () => {
      await ask(job.links.cancel, { method: "POST" });
      await refresh();
    });
    actions.append(cancel);
  }
  line.append(label, element("td", job.method), element("td", standing(job), job.status === "failed" ? "bad" : ""), verdict, since, actions);
  return line;
}

async function refresh() {
  clearTimeout(timer);
  const mine = ++asked;
  const status = at("filter").value;
  const list = await ask(`/v1/jobs?limit=${limit}${status ? `&status=${status}` : ""}`);
  if (mine !== asked) return;
  // A list that is rebuilt under the keyboard would lose the focus.
  const held = at("rows").contains(document.activeElement) ? document.activeElement.closest("tr").rowIndex - 1 : -1;
  at("rows").replaceChildren(...list.items.map(row));
  at("rows").children[held]?.querySelector("button, a")?.focus();
  at("jobs").hidden = list.items.length === 0;
  at("empty").hidden = list.items.length > 0;
  at("empty").textContent = status ? `No jobs are ${status}.` : "No jobs yet: try an example.";
  at("more").hidden = !list.next_cursor || limit >= 200;
  if (list.items.some((job) => !ended(job))) timer = setTimeout(() => attempt(refresh), BEAT);
}

async function submit() {
  const example = examples.find((e) => e.name === at("example").value);
  const body = await (await fetch(example.href)).text();
  const job = await ask("/v1/jobs", { method: "POST", headers: { "Content-Type": "application/json" }, body });
  tell(`Submitted ${job.label ?? example.name}.`);
  await refresh();
}

/** Runs it and tells what goes wrong. */
async function attempt(what) {
  try { await what(); } catch (error) { tell(String(error.message)); }
}

function describe() {
  at("about").textContent = examples.find((e) => e.name === at("example").value)?.description ?? "";
}

at("filter").onchange = () => attempt(refresh);
at("example").onchange = describe;
at("submit").onclick = () => attempt(submit);
at("more").onclick = () => { limit = 200; attempt(refresh); };
attempt(async () => {
  examples = (await ask("/v1/examples")).items;
  at("example").replaceChildren(...examples.map((e) => {
    const option = element("option", `${e.name} (${e.method})`);
    option.value = e.name;
    return option;
  }));
  const first = examples.find((e) => e.name === "trawler");
  if (first) at("example").value = first.name;
  describe();
});
attempt(refresh);
