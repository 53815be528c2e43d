/* The page's style out, a rule an item. Colours are variables, so that dark is a change of
 * variables alone; an outcome is always a word too, never a colour alone. */
#include "style.h"

#include <stddef.h>

const char *const pl_style[] = {
    ":root{color-scheme:light dark;--page:#fbfaf7;--card:#fff;--ink:#1d2129;"
    "--soft:#5c6370;--line:#dcdad3;--head:#f1efe9;--accent:#9a5b13;--good:#1c7a43;"
    "--good-wash:#e8f4ea;--bad:#b3261e;--bad-wash:#fbe9e7;--none:#7a7f88;--none-wash:#efefec;"
    "--sky:#f6f4ee;--ground:#d9d4c6;--edge:#3a3f47;--expected:#b3261e;--d0:#3d5673;"
    "--d1:#4f6c8d;--d2:#6483a6;--d3:#7f9cbc;--d4:#9db5cf;--d5:#c0d1e2;--s0:#77705f;"
    "--s1:#8b8473;--s2:#a09987;--s3:#b5ae9d;--s4:#c8c2b3;--s5:#dad5c9;--f0:#7a3a22;"
    "--f1:#95492c;--f2:#b05c3a;--f3:#c8754f;--f4:#dd946f;--f5:#efb89a}",
    "@media screen and "
    "(prefers-color-scheme:dark){:root{--page:#15181d;--card:#1c2026;--ink:#e4e6ea;"
    "--soft:#9aa2ad;--line:#343a43;--head:#252a32;--accent:#e0a458;--good:#6cc78c;"
    "--good-wash:#1b2e23;--bad:#ff8a7d;--bad-wash:#3a2120;--none:#98a0aa;--none-wash:#2a2e35;"
    "--sky:#20252c;--ground:#3a3c3b;--edge:#0d1014;--expected:#ff8a7d;--s0:#3f4142;"
    "--s1:#4a4d4e;--s2:#57595a;--s3:#646768;--s4:#727576;--s5:#818485}}",
    "*{box-sizing:border-box}",
    "body{margin:0;background:var(--page);color:var(--ink);font:15px/1.5 system-ui,'Segoe "
    "UI',Roboto,'Helvetica Neue',Arial,'DejaVu Sans',sans-serif}",
    "main{max-width:1180px;margin:0 auto;padding:24px 20px 60px}",
    "h1{font-size:28px;line-height:1.2;margin:0 0 4px}",
    "h2{font-size:21px;margin:44px 0 8px;padding-top:10px;border-top:2px solid var(--accent)}",
    "h3{font-size:17px;margin:32px 0 4px}",
    "h4{font-size:14px;margin:18px 0 4px;color:var(--soft);font-weight:600}",
    "p{margin:6px 0;max-width:90ch;overflow-wrap:anywhere}",
    ".lead{font-size:17px;color:var(--soft)}",
    ".note,.small{color:var(--soft);font-size:13px;font-weight:400}",
    ".warn{border-left:4px solid var(--bad);background:var(--bad-wash);padding:8px 12px}",
    ".verdict{font-size:17px;font-weight:600}",
    "code,pre,.formula{font-family:ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,monospace;"
    "font-size:13px}",
    "pre{background:var(--head);border:1px solid var(--line);border-radius:4px;padding:8px "
    "10px;margin:4px 0;overflow:auto;max-height:240px;white-space:pre-wrap;"
    "overflow-wrap:anywhere}",
    "a{color:var(--accent)}",
    "dl.facts{display:grid;grid-template-columns:max-content 1fr;gap:2px 14px;margin:14px 0;"
    "font-size:13px}",
    "dl.facts dt{color:var(--soft)}",
    "dl.facts dd{margin:0;overflow-wrap:anywhere}",
    "dl.metrics dt{font-weight:600;margin-top:8px}",
    "dl.metrics dd{margin:0 0 0 18px}",
    ".scroll{overflow-x:auto;margin:10px 0;border:1px solid var(--line);border-radius:6px;"
    "background:var(--card)}",
    "table{border-collapse:separate;border-spacing:0;width:100%;font-size:13.5px;"
    "font-variant-numeric:tabular-nums}",
    "th,td{padding:6px 10px;text-align:left;vertical-align:top;border-bottom:1px solid "
    "var(--line)}",
    "tbody tr:last-child>*{border-bottom:0}",
    "thead th{background:var(--head);font-weight:600;white-space:nowrap;"
    "vertical-align:bottom}",
    "th:first-child{position:sticky;left:0;background:var(--head);z-index:1}",
    "tbody th{font-weight:600;min-width:110px}",
    "td.n,th.n{text-align:right;white-space:nowrap}",
    "td.answer{min-width:240px;max-width:320px;font-size:12.5px;overflow-wrap:anywhere}",
    "td.why{min-width:220px;overflow-wrap:anywhere}",
    "td.ok{background:var(--good-wash)}",
    "td.bad{background:var(--bad-wash)}",
    "td.none{background:var(--none-wash);color:var(--none)}",
    "td .time{display:block;color:var(--soft);font-size:12px}",
    ".badge{display:inline-block;border-radius:3px;padding:0 6px;font-size:12px;"
    "font-weight:600}",
    ".badge.bad{color:var(--bad);background:var(--bad-wash);border:1px solid var(--bad)}",
    ".badge.none{color:var(--none);background:var(--none-wash);border:1px solid var(--none)}",
    ".best{font-weight:700;color:var(--good)}",
    "[title]:not(svg *){text-decoration:underline dotted var(--line);"
    "text-underline-offset:3px;cursor:help}",
    "details>summary{cursor:pointer;color:var(--accent);margin:8px 0}",
    ".pictures{display:flex;flex-wrap:wrap;gap:14px;margin:12px 0}",
    "figure{margin:0;max-width:100%}",
    "figure svg{display:block;max-width:100%;height:auto;background:var(--sky);border:1px "
    "solid var(--line);border-radius:6px}",
    ".empty{display:flex;align-items:center;justify-content:center;max-width:100%;border:1px "
    "dashed var(--line);border-radius:6px;color:var(--none);font-size:13px;text-align:center;"
    "padding:10px}",
    "figcaption{font-size:13px;color:var(--soft);margin-top:3px}",
    "figcaption b{color:var(--ink)}",
    "svg.defs{position:absolute}",
    ".ground{fill:var(--ground);stroke:var(--line)}",
    ".expected,.start{fill:none;stroke:var(--expected);stroke-width:1.2;stroke-dasharray:4 3}",
    ".start{stroke:var(--none);stroke-dasharray:1.5 2.5}",
    ".glint{fill:#fff;opacity:.35}",
    "svg [class^=d],svg [class^=s],svg [class^=f]{stroke:var(--edge);stroke-width:.5;"
    "stroke-linejoin:round}",
    "svg .start{stroke:var(--none);stroke-width:1.2}",
    "svg .fine{stroke-width:.3;stroke-opacity:.3}",
    ".d0{fill:var(--d0)}",
    ".d1{fill:var(--d1)}",
    ".d2{fill:var(--d2)}",
    ".d3{fill:var(--d3)}",
    ".d4{fill:var(--d4)}",
    ".d5{fill:var(--d5)}",
    ".s0{fill:var(--s0)}",
    ".s1{fill:var(--s1)}",
    ".s2{fill:var(--s2)}",
    ".s3{fill:var(--s3)}",
    ".s4{fill:var(--s4)}",
    ".s5{fill:var(--s5)}",
    ".f0{fill:var(--f0)}",
    ".f1{fill:var(--f1)}",
    ".f2{fill:var(--f2)}",
    ".f3{fill:var(--f3)}",
    ".f4{fill:var(--f4)}",
    ".f5{fill:var(--f5)}",
    "@media (max-width:600px){body{font-size:14px}main{padding:14px 10px 40px}h1{"
    "font-size:23px}th,td{padding:5px 7px}dl.facts{"
    "gap:2px 8px}}",
    "@media print{:root{color-scheme:light}body{font-size:10pt;background:#fff}main{"
    "max-width:none;padding:0}.scroll{overflow:visible}table{font-size:8pt}th,td{padding:2px "
    "4px}thead th{white-space:normal}td.n,th.n{white-space:normal}td.answer,td.why,tbody th{"
    "min-width:0}th:first-child{position:static}h2,h3,h4{break-after:avoid}figure,tr,"
    "dl.facts{break-inside:avoid}pre{max-height:none}}",
    "@media print{td .time,td .small,th .small,td .badge,td.answer{font-size:7.5pt}}",
    "@media print{details::details-content{content-visibility:visible;display:block}}",
    NULL};
