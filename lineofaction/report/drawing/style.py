"""The page's style sheet: one column of text measure, tables that read, and a print form."""

from __future__ import annotations

STYLE = """
:root { --ink: #1b1f24; --muted: #59636e; --rule: #dde1e6; --paper: #ffffff; --wash: #f6f7f9;
  --link: #0b5394; }
* { box-sizing: border-box; }
html { font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "Liberation Sans", sans-serif; color: var(--ink);
  background: var(--paper); -webkit-text-size-adjust: 100%; }
body { max-width: 66rem; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; letter-spacing: -.01em; }
h2 { font-size: 1.3rem; line-height: 1.3; margin: 3rem 0 .5rem; padding-top: .8rem;
  border-top: 2px solid var(--ink); }
h3 { font-size: 1.05rem; margin: 2rem 0 .4rem; }
p { max-width: 44rem; margin: .4rem 0 .8rem; }
a { color: var(--link); }
a:focus-visible, summary:focus-visible { outline: 3px solid #e69f00; outline-offset: 2px; }
.lead { color: var(--muted); font-size: 1.05rem; }
.skip { position: absolute; left: -100rem; }
.skip:focus { left: 1rem; top: .5rem; background: var(--paper); padding: .5rem; }
nav ol { columns: 2; padding-left: 1.3rem; margin: .3rem 0; }
.headline { display: flex; flex-wrap: wrap; gap: 1rem 2.5rem; margin: 1.6rem 0; padding: 0; }
.headline div { margin: 0; }
.headline dt { color: var(--muted); font-size: .85rem; }
.headline dd { margin: 0; font-size: 1.5rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.headline small { font-size: .85rem; font-weight: 400; color: var(--muted); }
.alarm { border-left: 5px solid #d55e00; background: #fff4ec; padding: .7rem 1rem; max-width: none; }
figure { margin: 1.2rem 0 2.2rem; }
figcaption { max-width: 44rem; color: var(--muted); font-size: .92rem; }
.plot { width: 100%; }
/* the bar of buttons stands above a legend, not on it */
.plot:has(.legend) { margin-top: 30px; }
.plot:has(.legend) .modebar-container { top: -30px !important; }
.player { margin: .6rem 0; }
.player p { color: var(--muted); font-size: .92rem; }
.still { display: none; max-width: 100%; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums;
  margin: .5rem 0 1.2rem; }
caption { text-align: left; font-weight: 600; padding: .3rem 0; }
th, td { text-align: left; vertical-align: top; padding: .28rem 1.1rem .28rem 0;
  border-bottom: 1px solid var(--rule); }
thead th { border-bottom: 1.5px solid var(--ink); white-space: nowrap; }
tbody th { font-weight: 500; }
th.n, td.n { text-align: right; white-space: nowrap; }
thead th.n { white-space: normal; }
details { margin: .3rem 0 1rem; }
summary { cursor: pointer; color: var(--link); font-size: .92rem; padding: .2rem 0; }
footer { margin-top: 4rem; color: var(--muted); font-size: .88rem; border-top: 1px solid var(--rule);
  padding-top: .8rem; }
@media (max-width: 40rem) { nav ol { columns: 1; } }
@media print {
  html { font-size: 10.5pt; }
  body { max-width: none; padding: 0; }
  nav, .skip, summary, .modebar { display: none !important; }
  h2 { break-after: avoid; }
  figure, tr { break-inside: avoid; }
  .plot, .player label, .player fieldset { display: none; }
  .still { display: block; }
  a { color: inherit; text-decoration: none; }
}
"""
