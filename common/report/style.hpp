// How the report page looks: its style sheet, inline because the page must open from a file.
#pragma once

namespace fathom::report {

constexpr const char* kStyle = R"css(
:root{--ink:#22262b;--soft:#5b6470;--line:#dfe3e8;--before:#e07b00;--after:#0a5ea8;--paper:#fff;--ground:#f4f6f8}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--ink);font:16px/1.5 system-ui,"Segoe UI","DejaVu Sans",Arial,sans-serif}
main{max-width:1200px;margin:0 auto;padding:20px}
section,header{background:var(--paper);border:1px solid var(--line);border-radius:8px;padding:20px 26px;margin:0 0 18px}
h1{font-size:25px;margin:0 0 2px}h2{font-size:20px;margin:0 0 4px}h3{font-size:16px;margin:18px 0 4px}
p{margin:6px 0;max-width:96ch}.soft{color:var(--soft)}.small{font-size:14px}
.lead{font-size:18px;max-width:90ch}
.badge{display:inline-block;color:#fff;font-weight:700;font-size:24px;padding:8px 18px;border-radius:8px;margin:12px 0 4px}
.adequate{background:#00705a}.effect{background:#0a5ea8}.ambiguous{background:#8a5a00}.unexplained{background:#9c2f5c}.other{background:#5b6470}
.tiles{display:grid;grid-template-columns:repeat(4,1fr);gap:12px;margin-top:14px}
.tile{border:1px solid var(--line);border-radius:8px;padding:10px 14px;font-size:14px;color:var(--soft)}
.tile b{display:block;font-size:23px;line-height:1.3;color:var(--ink);overflow-wrap:anywhere}
.key{position:sticky;top:0;z-index:1;background:var(--paper);border:1px solid var(--line);border-radius:8px;
 padding:7px 26px;margin:0 0 18px;font-size:14px;display:flex;flex-wrap:wrap;gap:4px 24px}
.key i{display:inline-block;width:26px;height:0;border-top:4px solid;vertical-align:middle;margin-right:7px}
.grid{display:grid;grid-template-columns:repeat(3,1fr);gap:8px 18px}
.grid.pair{grid-template-columns:repeat(2,1fr)}
table.errors td:nth-child(4n+2),table.errors th.group{border-left:2px solid var(--line)}
th.group{text-align:center}.grid figure{margin:6px 0}
svg,img{display:block;width:100%;height:auto}figure{margin:10px 0}figcaption{font-size:14px;color:var(--soft);max-width:110ch}
table{border-collapse:collapse;width:100%;font-size:14px;margin:10px 0}
th{text-align:left;font-weight:600;color:var(--soft);border-bottom:2px solid var(--line);padding:4px 8px;vertical-align:bottom}
td{border-bottom:1px solid var(--line);padding:5px 8px;vertical-align:top;overflow-wrap:break-word}
.paper{font-size:13px;font-weight:400;color:var(--soft);margin-left:8px}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
td.k{white-space:nowrap;font-weight:600}
.b{color:#a85c00}.a{color:var(--after);font-weight:600}
.bar+div{font-size:13px;font-variant-numeric:tabular-nums;margin-top:2px;white-space:nowrap}
td.bars{width:21%}td.name{width:24%;font-weight:600}td.mid{vertical-align:middle;width:34%}sup{font-size:10px;line-height:0}
tr.yes td{background:#eaf2fa}tr.sub td{background:#f4f6f8;font-weight:600}
.mark{display:inline-block;background:var(--after);color:#fff;border-radius:4px;padding:0 7px;font-size:12px;font-weight:700;white-space:nowrap}
.mark.no{background:#fff;color:var(--soft);border:1px solid #b8bec7}
.bar{position:relative;height:15px;background:#eef0f3;border-radius:3px;min-width:130px}
.bar span{position:absolute;top:0;bottom:0;background:#9aa3ae;border-radius:2px}
.yes .bar span{background:var(--after)}.bar u{position:absolute;top:-2px;bottom:-2px;width:0;border-left:2px solid #5b6470}
.two{display:flex;gap:3px}.two span{flex:1;text-align:center;padding:3px 0;border-radius:3px;min-width:38px;font-variant-numeric:tabular-nums}
details{margin:8px 0;border:1px solid var(--line);border-radius:8px;padding:6px 14px}
summary{cursor:pointer;font-weight:600}td details{border:0;padding:0;margin:0}td summary{font-weight:400;color:var(--after)}
.note{border-left:4px solid var(--after);background:#f1f6fb;padding:8px 14px;border-radius:0 6px 6px 0}
details.section{background:var(--paper);padding:12px 26px;margin:0 0 12px}
details.section>summary h2{display:inline;font-size:18px}
ul.causes{font-size:19px;margin:12px 0 4px;padding-left:22px}ul.causes li{margin:4px 0}ul.causes .soft{font-size:15px}
dt{font-weight:600}dd{margin:0 0 8px;color:var(--soft)}dl{font-size:14px;margin:4px 0;columns:2;column-gap:36px}dl div{break-inside:avoid}
@media screen and (max-width:800px){.grid,.grid.pair{grid-template-columns:1fr}.tiles{grid-template-columns:1fr 1fr}dl{columns:1}
 main{padding:8px}section,header,details.section{padding:12px;overflow-x:auto}.badge{font-size:19px}.tile b{font-size:18px}
 table{display:block;overflow-x:auto}
 h1{font-size:21px}ul.causes{font-size:17px}td.bars,td.name{width:auto}.key{padding:6px 12px}}
@page{size:A4;margin:11mm}
@media print{*{-webkit-print-color-adjust:exact;print-color-adjust:exact}.key{position:static;padding:3px 12px;margin:0 0 6px;font-size:9px}body{background:#fff;font-size:10px;line-height:1.35}
 main{padding:0;max-width:none}section,header,details.section{break-inside:auto;padding:6px 12px;margin:0 0 6px}
 details.section:not([open]){padding:3px 12px;margin:0 0 3px}details{padding:2px 10px;margin:3px 0}
 h1{font-size:17px}h2,details.section>summary h2{font-size:13px}h3{font-size:11px;margin:6px 0 2px}.badge{font-size:15px;padding:4px 10px}
 ul.causes{font-size:12px}ul.causes .soft,.small,table,figcaption,dl,.lead{font-size:9px}.tile{font-size:9px;padding:5px 8px}.tile b{font-size:13px}
 .tiles{margin-top:6px;gap:6px}td,th{padding:1px 5px}td.mid svg{max-height:16px}.bar{height:9px}.bar+div{font-size:9px}.two span{padding:0;min-width:24px}
 .grid{gap:2px 8px}.grid.pair{grid-template-columns:repeat(4,1fr)}.grid figure,figure{margin:2px 0}figure,tr{break-inside:avoid}
 header .plot svg{max-height:230px}}
)css";

}  // namespace fathom::report
