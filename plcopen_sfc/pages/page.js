"use strict";
const all = (selector, root = document) => [...root.querySelectorAll(selector)];
const byId = (id) => document.getElementById(id);

/* search: names first, then rows of tables, lines of program text and of types, comments and findings */
const field = byId("search"), found = byId("found");
field.parentElement.hidden = false;
let entries = null;
function named() {
  return all("[data-name]").filter((each) => each.dataset.name).map((each) => {
    const owner = each.closest("section"), name = each.dataset.name;
    const [part, step] = each.id.split("-step-"); /* of several charts in a body each has a heading */
    const chart = step && byId(`${part}-heading`)?.dataset.name;
    const around = owner && owner !== each ? [owner.dataset.name, chart].filter(Boolean).join(" / ") : "";
    const text = each.localName === "tr" ? each.textContent.toLowerCase() : "";
    return { at: each.id ? each : each.closest("[id]"), label: around ? `${name} \u2013 ${around}` : name,
      name: name.toLowerCase(), text };
  });
}
function told() {
  const kinds = ":is(pre, p, .comment, .findings > li)"; /* what is in one of these is found with it */
  const places = all(`main ${kinds}`).filter((each) => !each.closest("tr, .uses") && !each.parentElement.closest(kinds));
  return places.flatMap((at) => {
    const owner = at.closest("[data-name]")?.dataset.name || at.closest("section")?.dataset.name || "";
    const words = [...at.childNodes].map((each) => `${/^(DIV|P|UL)$/.test(each.nodeName) ? " " : ""}${each.textContent}`);
    const lines = at.localName === "pre" ? at.textContent.split("\n") : [words.join("")];
    return lines.filter((line) => line.trim()).map((line) => ({ at, owner, line: line.trim(), text: line.toLowerCase() }));
  });
}
function cut(line, wanted) { /* the part of a line that has what was looked for */
  const start = Math.max(0, line.toLowerCase().indexOf(wanted) - 30), end = start + 90;
  return `${start ? "\u2026" : ""}${line.slice(start, end)}${end < line.length ? "\u2026" : ""}`;
}
function look() {
  entries ??= [named(), told()];
  const wanted = field.value.trim().toLowerCase();
  found.replaceChildren();
  if (!wanted) return;
  const names = entries[0].filter((each) => each.name.includes(wanted));
  const rows = entries[0].filter((each) => !each.name.includes(wanted) && each.text.includes(wanted));
  const texts = entries[1].filter((each) => each.text.includes(wanted)).map((each) => {
    const line = cut(each.line, wanted);
    return { at: each.at, label: each.owner ? `${each.owner}: ${line}` : line };
  });
  for (const hit of [...names, ...rows, ...texts].slice(0, 60)) {
    const link = document.createElement("a");
    hit.at.id ||= `place-${all("[id^=place-]").length}`;
    link.href = `#${hit.at.id}`;
    link.textContent = hit.label;
    link.addEventListener("click", () => {
      for (let around = hit.at.closest("details"); around; around = around.parentElement.closest("details"))
        around.open = true;
    });
    found.appendChild(document.createElement("li")).appendChild(link);
  }
  if (!found.childElementCount) {
    found.appendChild(document.createElement("li")).appendChild(document.createElement("span")).textContent =
      found.dataset.nothing;
  }
}
field.addEventListener("input", look);
found.addEventListener("click", () => found.replaceChildren());
document.addEventListener("keydown", (event) => {
  const links = all("a", found), at = links.indexOf(document.activeElement);
  const typing = /^(INPUT|TEXTAREA|SELECT)$/.test(event.target.tagName);
  if (event.key === "/" && !typing) {
    event.preventDefault();
    field.select();
  } else if (event.key === "Escape") {
    found.replaceChildren();
    field.blur();
  } else if (links.length && (event.target === field || at >= 0) && /^Arrow(Up|Down)$/.test(event.key)) {
    event.preventDefault();
    const next = at + (event.key === "ArrowDown" ? 1 : -1);
    (next < 0 ? field : links[Math.min(next, links.length - 1)]).focus();
  } else if (links.length && event.target === field && event.key === "Enter") {
    links[0].click();
  }
});

/* pictures: a step or transition leads to its row; a button fits the picture into the page */
document.addEventListener("click", (event) => {
  const drawn = event.target.closest(":is(g.step, g.transition)[id]");
  const row = drawn && `${drawn.id.replace(/^trace-/, "")}-row`;
  if (drawn && !event.target.closest("a") && byId(row)) location.hash = row;
});
const resize = (figure, scale) => {
  const picture = figure.querySelector("svg"), box = picture.viewBox.baseVal;
  picture.setAttribute("width", box.width * scale);
  picture.setAttribute("height", box.height * scale);
};
for (const button of all("button.fit")) {
  button.addEventListener("click", () => {
    const figure = button.closest("figure");
    if (!figure.classList.toggle("fitted")) resize(figure, 1);
    arrange();
  });
}

/* pictures beside each other: of one scale, as large as the page has room; where that is too small they are scrolled */
for (const figure of all(".pair figure")) figure.classList.add("fitted");
function arrange() {
  const phone = matchMedia("(max-width: 48rem)").matches;
  for (const pair of all(".pair")) {
    const figures = all("figure.fitted", pair).filter((each) => each.querySelector("svg"));
    const widths = figures.map((each) => each.querySelector("svg").viewBox.baseVal.width);
    const room = pair.closest("section").clientWidth - 16; /* of the pair itself it may not be known yet */
    const together = room / widths.reduce((sum, each) => sum + each, 0);
    const scrolled = figures.length === 2 && together < 0.6 && !phone;
    const bar = 20, half = Math.min(0.75, (room / 2 - bar) / Math.min(...widths)); /* the narrower one has half of it */
    const scales = widths.map((each) => (scrolled ? half : phone ? room / each : together));
    figures.forEach((each, index) => resize(each, Math.min(1, Math.max(0.6, scales[index]))));
    pair.classList.toggle("scrolled", scrolled);
    for (const figure of all("figure", pair)) figure.style.flexBasis = "";
    if (scrolled) {
      const [one, other] = widths.map((each) => Math.max(0.6, half) * each + bar);
      const first = Math.min(one, Math.max(room / 2, room - other));
      [first, room - first].forEach((width, index) => { figures[index].style.flexBasis = `${width}px`; });
    }
  }
  for (const button of all("button.fit")) { /* what fits in full size needs none */
    const room = button.closest("figure").querySelector(".scroll");
    button.hidden = room.querySelector("svg").viewBox.baseVal.width <= room.clientWidth;
  }
}
arrange();
addEventListener("resize", arrange);
addEventListener("toggle", arrange, true); /* what was closed had no width */

for (const pair of all(".pair")) { /* the same steps are at one height */
  pair.addEventListener("scroll", (event) => {
    const moved = event.target;
    if (!pair.classList.contains("scrolled") || !moved.matches(":hover, :focus-within")) return;
    for (const each of all("figure.fitted > .scroll", pair)) each.scrollTop = moved.scrollTop;
  }, true);
}

/* on paper all is open */
let closed = [];
addEventListener("beforeprint", () => {
  closed = all("details:not([open])");
  for (const each of closed) each.open = true;
});
addEventListener("afterprint", () => {
  for (const each of closed) each.open = false;
});
if (matchMedia("(max-width: 48rem)").matches) byId("contents").open = false;

/* a trace: one change after the other, on the chart and in the timing diagram */
const player = byId("player");
if (player) {
  const trace = JSON.parse(byId("trace-data").textContent);
  const [range, output, timing] = [byId("scan"), player.querySelector("output"), byId("timing")];
  const picture = timing.querySelector("svg"), cells = all("#trace .value");
  const cursor = document.createElementNS(picture.namespaceURI, "line");
  cursor.setAttribute("class", "cursor");
  cursor.setAttribute("y1", trace.top);
  cursor.setAttribute("y2", picture.getAttribute("height"));
  picture.append(cursor);
  const at = (runs, scan) => {
    let low = 0, high = runs.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (runs[middle][0] <= scan) low = middle;
      else high = middle;
    }
    return runs[low]?.[1] ?? "";
  };
  const show = () => {
    const scan = trace.events[range.value], active = at(trace.situations, scan) || [];
    for (const step of all(".now")) step.classList.remove("now");
    output.replaceChildren(`${trace.times[range.value]} `);
    for (const [name, anchor] of active) {
      for (const id of [anchor, `trace-${anchor}`]) byId(id)?.classList.add("now");
      const link = document.createElement(anchor ? "a" : "span");
      if (anchor) link.href = `#${anchor}`;
      link.textContent = name;
      output.append(link, " ");
    }
    cells.forEach((cell, index) => (cell.textContent = at(trace.columns[index], scan)));
    const x = trace.left + (scan + 0.5) * trace.width / trace.scans;
    cursor.setAttribute("x1", x);
    cursor.setAttribute("x2", x);
    const line = cursor.getBoundingClientRect(), shown = timing.getBoundingClientRect();
    if (line.left < shown.left || line.right > shown.right) timing.scrollLeft += line.left - shown.left - shown.width / 2;
  };
  const play = player.querySelector("[data-move='0']");
  let timer = 0;
  const stop = () => {
    clearInterval(timer);
    timer = 0;
    play.textContent = "\u25b6";
  };
  const move = (by) => {
    range.value = Number(range.value) + by;
    show();
    if (range.value === range.max) stop();
  };
  player.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    const by = Number(button.dataset.move), was = timer;
    stop();
    if (by) return move(by);
    if (was) return;
    if (range.value === range.max) range.value = 0;
    show();
    timer = setInterval(move, 600, 1);
    play.textContent = "\u2759\u2759";
  });
  range.addEventListener("input", () => {
    stop();
    show();
  });
  timing.addEventListener("click", (event) => {
    const box = picture.getBoundingClientRect();
    const scan = Math.floor((event.clientX - box.left - trace.left) * trace.scans / trace.width);
    range.value = trace.events.findLastIndex((each) => each <= Math.max(scan, 0));
    stop();
    show();
  });
  if (trace.scans) {
    player.hidden = false;
    show();
  }
}
