// Style sheet of the report. Colours of the lines differ in hue and in
// lightness, so that they can be told apart in print and by most eyes.
#pragma once

namespace waymark {

inline constexpr const char* kReportStyle = R"(:root {
  --ink: #1a1d21; --soft: #5b6470; --paper: #ffffff; --card: #f6f7f9;
  --rule: #d9dde3; --accent: #0b62a8; --bad: #b3261e; --warn: #fff3d6;
  --warn-ink: #6b4a00;
  --truth: #9aa3ad; --raw: #d55e00; --online: #56a8e0; --settled: #0b5fa5;
  --batch: #009e73; --fix: #b0479a; --band: rgba(0, 158, 115, 0.13);
}
@media (prefers-color-scheme: dark) {
  :root {
    --ink: #e6e9ed; --soft: #9ba5b1; --paper: #14171b; --card: #1d2127;
    --rule: #343b44; --accent: #6db7f2; --bad: #ff8a80; --warn: #3a2f14;
    --warn-ink: #ffd98a;
    --truth: #7d8792; --raw: #ff8a3d; --online: #2f7fc1; --settled: #8ecbff;
    --batch: #35d0a0; --fix: #e08bd0; --band: rgba(53, 208, 160, 0.14);
  }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body {
  margin: 0; background: var(--paper); color: var(--ink);
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans",
    sans-serif;
}
header, main { max-width: 1180px; margin: 0 auto; padding: 0 20px; }
header { padding-top: 28px; }
h1 { font-size: 26px; margin: 0; }
header p { margin: 4px 0 0; color: var(--soft); }
nav { margin: 12px 0 0; line-height: 2; }
nav a {
  color: var(--accent); text-decoration: none; border: 1px solid var(--rule);
  border-radius: 6px; padding: 2px 9px; margin-right: 4px;
  white-space: nowrap;
}
section { padding: 8px 0 20px; border-bottom: 1px solid var(--rule); }
section:last-child { border-bottom: 0; }
h2 { font-size: 20px; margin: 18px 0 8px; overflow-wrap: anywhere; }
h3 { font-size: 16px; margin: 22px 0 8px; }
h4 { margin: 12px 0 4px; }
p { margin: 8px 0; max-width: 78ch; }
.small { font-size: 13px; color: var(--soft); }
.badge {
  font-size: 12px; font-weight: 600; vertical-align: 3px; padding: 2px 8px;
  border-radius: 10px; background: var(--warn); color: var(--warn-ink);
  white-space: nowrap;
}
.notes { margin: 8px 0; padding: 8px 14px 8px 30px; background: var(--card);
  border-radius: 8px; font-size: 14px; max-width: 90ch; }
.scroll { overflow-x: auto; margin: 10px 0; }
table { border-collapse: collapse; font-size: 14px; min-width: 60%;
  font-variant-numeric: tabular-nums; }
th, td { padding: 5px 12px; text-align: right; white-space: nowrap;
  border-bottom: 1px solid var(--rule); }
th { color: var(--soft); font-weight: 600; font-size: 13px; }
th:first-child, td:first-child { text-align: left; padding-left: 2px; }
td.name { font-weight: 600; }
td.bad { color: var(--bad); font-weight: 600; }
.plots { display: grid; gap: 16px; margin: 14px 0;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 460px), 1fr));
  align-items: start; }
.three { grid-template-columns: repeat(auto-fill, minmax(min(100%, 340px), 1fr)); }
figure { margin: 0; background: var(--card); border: 1px solid var(--rule);
  border-radius: 10px; padding: 12px 12px 6px; min-width: 0; }
figcaption { font-weight: 600; margin-bottom: 4px; }
.legend { list-style: none; display: flex; flex-wrap: wrap; gap: 2px 14px;
  margin: 0 0 6px; padding: 0; font-size: 13px; color: var(--soft); }
.legend svg { width: 22px; height: 10px; margin-right: 5px;
  display: inline-block; }
.wide { grid-template-columns: 1fr; }
figure > svg, figure > img { width: 100%; height: auto; display: block; }
.grid { stroke: var(--rule); stroke-width: 1; }
.frame { fill: none; stroke: var(--soft); stroke-width: 1; }
.tick { font-size: 11.5px; fill: var(--soft); }
.label { font-size: 12.5px; fill: var(--ink); }
.three .tick { font-size: 14.5px; } .three .label { font-size: 15.5px; }
.line { fill: none; stroke: currentColor; stroke-width: 1.6;
  stroke-linejoin: round; }
.dashed { stroke-dasharray: 6 4; }
.line.truth { stroke-width: 4.5; stroke-opacity: 0.75; }
.dot { fill: currentColor; fill-opacity: 0.8; }
.halo { fill: currentColor; fill-opacity: 0.16; }
.band { fill: var(--band); }
.truth { color: var(--truth); } .raw { color: var(--raw); }
.online { color: var(--online); } .settled { color: var(--settled); }
.batch { color: var(--batch); } .fix { color: var(--fix); }
.nodata { color: var(--soft); }
details { margin: 14px 0; }
summary { cursor: pointer; font-weight: 600; color: var(--accent); }
pre { background: var(--card); border: 1px solid var(--rule);
  border-radius: 8px; padding: 10px; overflow-x: auto; font-size: 12.5px; }
dt { font-weight: 600; margin-top: 8px; }
dd { margin: 0; max-width: 90ch; }
@media (max-width: 560px) {
  header, main { padding-left: 12px; padding-right: 12px; }
  figure { padding: 10px 6px 4px; }
  th, td { padding: 5px 8px; }
  /* The drawing shrinks to the screen; its letters shall not. */
  .tick { font-size: 14px; } .label { font-size: 15px; }
}
@media print { .plots { display: block; } figure { break-inside: avoid; } }
)";

}  // namespace waymark
