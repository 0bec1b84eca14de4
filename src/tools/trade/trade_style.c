/* trade_style: how the page looks and moves: one style sheet, one short script, both inside the page. Nothing is
 * fetched: fonts are the reader's own.
 *
 * The script swaps the slider's pictures and moves its cut; without it the page still says everything. With #selftest
 * behind its address it moves the cut and the choice by itself and says in <html data-selftest> what came of it: `make
 * test-browser` reads that. */
#include "trade.h"

const char bis_trade_style[] =
    ":root{color-scheme:light dark;--paper:#fbfaf7;--card:#fff;--ink:#1d2129;--soft:#5d6470;--line:#e3e1da;--faint:#f0eee8;"
    "--em:#b87503;--brdf:#0d8a7f;--mis:#7a52cc;--rejection:#c8436d;--sir:#1c64d9;--auto:#3f4652}\n"
    "@media(prefers-color-scheme:dark){:root{--paper:#14161a;--card:#1c1f25;--ink:#e8e6e1;--soft:#9aa1ad;--line:#30343c;--faint:#23262d;"
    "--em:#e5a93c;--brdf:#3cc4b6;--mis:#ac8df0;--rejection:#f07d9f;--sir:#6ba3ff;--auto:#c3cad6}}\n"
    ".k-em{--c:var(--em)}.k-brdf{--c:var(--brdf)}.k-mis{--c:var(--mis)}.k-rejection{--c:var(--rejection)}.k-sir{--c:var(--sir)}.k-auto{--c:var(--auto)}\n"
    "*{box-sizing:border-box}\n"
    "body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',sans-serif;"
    "font-variant-numeric:tabular-nums}\n"
    "main{max-width:1080px;margin:0 auto;padding:48px 28px 72px}\n"
    "h1,h2{font-family:ui-serif,'Iowan Old Style',Charter,Georgia,serif;font-weight:600;line-height:1.15;text-wrap:balance}\n"
    "h1{font-size:44px;letter-spacing:-.015em;margin:4px 0 10px;overflow-wrap:anywhere}h2{font-size:27px;margin:72px 0 6px}\n"
    ".kicker{margin:0;color:var(--soft);font-size:13px;letter-spacing:.09em;text-transform:uppercase}\n"
    ".lede{max-width:66ch;margin:0;color:var(--soft);font-size:18px}h2+p{max-width:70ch;margin:0 0 22px;color:var(--soft)}\n"
    ".note-box{border-left:3px solid var(--em);padding:2px 0 2px 14px;margin:22px 0;max-width:70ch}\n"
    "code{font:13px/1.5 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace}\n"
    /* advice */
    ".advice{display:grid;grid-template-columns:repeat(auto-fit,minmax(270px,1fr));gap:18px;margin:36px 0 0}\n"
    ".card{display:flex;flex-direction:column;background:var(--card);border:1px solid var(--line);border-top:4px solid var(--c,var(--line));border-radius:10px;padding:20px 22px 18px}\n"
    ".card h3{margin:0;font-size:13px;font-weight:600;letter-spacing:.07em;text-transform:uppercase;color:var(--soft)}\n"
    ".card .big{font:600 38px/1.2 ui-serif,'Iowan Old Style',Charter,Georgia,serif;margin:6px 0 8px}.card p{margin:0 0 14px}\n"
    ".card code{display:block;margin-top:auto;padding:10px 12px;border-radius:6px;background:var(--faint);overflow-wrap:anywhere}.card code span{white-space:nowrap}\n"
    /* plot */
    ".scroll{overflow-x:auto}.panel{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:18px 18px 10px;overflow-x:auto}\n"
    "svg{display:block;width:100%;min-width:600px;height:auto}svg text{font:12px system-ui,-apple-system,'Segoe UI',Roboto,sans-serif;fill:var(--soft)}\n"
    "svg .title{font-size:12.5px}svg .name{font-size:13px;font-weight:650;fill:var(--c)}svg .note{font-size:11px}\n"
    ".grid{stroke:var(--line);stroke-width:.7}.axis{fill:none;stroke:var(--soft)}.law{stroke:var(--soft);stroke-width:.8;stroke-dasharray:1 5;stroke-linecap:round}\n"
    ".floor{stroke:var(--soft);stroke-dasharray:7 4}.front{fill:none;stroke:var(--ink);stroke-opacity:.13;stroke-width:13;stroke-linejoin:round;stroke-linecap:round}\n"
    ".curve{fill:none;stroke:var(--c);stroke-linejoin:round}.minor .curve{stroke-width:1.1;opacity:.38}.major .curve{stroke-width:2.3}\n"
    ".major g{fill:var(--card);stroke:var(--c);stroke-width:2}.major .bar{fill:none;stroke:var(--c);stroke-width:1.2}\n"
    ".key{display:flex;flex-wrap:wrap;gap:4px 22px;margin:12px 2px 0;color:var(--soft);font-size:13px}\n"
    /* bars */
    ".bars{display:grid;gap:5px}.row{display:grid;grid-template-columns:minmax(150px,230px) 1fr 52px;gap:12px;align-items:center;font-size:14px}\n"
    ".row em,th em{font-style:normal;font-size:11px;color:var(--soft);border:1px solid var(--line);border-radius:9px;padding:1px 7px;margin-left:4px;white-space:nowrap}\n"
    ".row>:last-child{text-align:right}.track{position:relative;height:16px;border-radius:3px;background:var(--faint)}\n"
    ".track i{position:absolute;inset:0 auto 0 0;border-radius:3px;background:var(--c);opacity:.85}.biased .track i{opacity:.32}\n"
    ".track b{position:absolute;top:7px;height:2px;background:var(--ink);opacity:.6}\n"
    /* pictures */
    ".pic{position:relative;width:100%;aspect-ratio:var(--ratio);background-size:100% 100%;image-rendering:pixelated;border-radius:3px}\n"
    ".strip{display:grid;grid-template-columns:repeat(auto-fit,minmax(126px,1fr));gap:26px 14px}figure{margin:0}\n"
    ".shot{display:flex;flex-direction:column;gap:6px}figcaption{font-size:13px;line-height:1.35;min-height:61px;border-top:3px solid var(--c,var(--soft));padding-top:6px}\n"
    "figcaption b{display:block;color:var(--c,var(--ink))}figcaption span,.figure{color:var(--soft)}.figure{margin:0;font-size:13px}.figure b{color:var(--ink);font-size:17px}\n"
    ".crops{display:grid;grid-template-columns:1fr 1fr;gap:6px}.crop{background-size:400% 400%}\n"
    ".frame{position:absolute;width:25%;height:25%;border:2px solid #fff;box-shadow:0 0 0 1px #0008}.crop0{outline:0}\n"
    ".scale{font-size:11px;color:var(--soft);margin-top:2px}.scale i{display:block;height:10px;border-radius:3px;margin:3px 0;"
    "background:linear-gradient(90deg,#000,#00f 25%,#f00 50%,#ff0 75%,#fff);border:1px solid var(--line)}.scale div{display:flex;justify-content:space-between}\n"
    /* slider */
    ".choose{max-width:820px;display:flex;justify-content:space-between;flex-wrap:wrap;gap:10px;margin:0 0 10px;font-size:14px;color:var(--soft)}\n"
    "select{font:inherit;color:var(--ink);background:var(--card);border:1px solid var(--line);border-radius:6px;padding:5px 8px;margin-left:6px}\n"
    ".pair{--cut:50%;position:relative;max-width:820px;border-radius:10px;overflow:hidden}.pair #over{position:absolute;inset:0;clip-path:inset(0 calc(100% - var(--cut)) 0 0)}\n"
    ".pair .cut{position:absolute;top:0;bottom:0;left:var(--cut);width:2px;margin-left:-1px;background:#fff;box-shadow:0 0 0 1px #0006;pointer-events:none}\n"
    ".pair .cut::after{content:'\\2194';position:absolute;top:50%;left:1px;transform:translate(-50%,-50%);width:36px;height:36px;border-radius:50%;background:#fff;color:#1d2129;"
    "font:20px/35px system-ui,sans-serif;text-align:center;box-shadow:0 1px 6px #0008}\n"
    ".pair input{position:absolute;inset:0;width:100%;height:100%;margin:0;opacity:0;cursor:ew-resize}.pair:focus-within .cut{width:4px;margin-left:-2px}\n"
    /* tables */
    "table{border-collapse:collapse;font-size:14px;min-width:100%}th,td{padding:6px 12px;text-align:right;white-space:nowrap;border-bottom:1px solid var(--line)}\n"
    "thead th{color:var(--soft);font-weight:500}th:first-child{text-align:left;position:sticky;left:0;background:var(--paper);font-weight:500}"
    "tbody th{box-shadow:inset 3px 0 0 var(--c)}tbody th:first-child{padding-left:14px}\n"
    "td{background:color-mix(in srgb,var(--sir) calc(var(--s,0%)*.24),transparent)}.none{color:var(--soft)}\n"
    "details{margin-top:18px}summary{cursor:pointer;color:var(--soft)}dl{display:grid;grid-template-columns:max-content 1fr;gap:6px 22px;margin:0;font-size:14.5px}"
    "dt{color:var(--soft)}dd{margin:0;max-width:76ch}\n"
    "@media(max-width:640px){main{padding:28px 16px 48px}h1{font-size:32px}h2{font-size:23px;margin-top:52px}.lede{font-size:16.5px}.panel{padding:10px}"
    ".row{grid-template-columns:128px 1fr 46px;gap:8px;font-size:12.5px}.row em{display:none}.strip{grid-template-columns:1fr 1fr}"
    "dl{grid-template-columns:1fr;gap:2px}dd{margin-bottom:10px}}\n"
    "@media print{.pair,.choose{display:none}h2{break-after:avoid}.card,.shot,tr{break-inside:avoid}}\n";

const char bis_trade_script[] =
    "(function(){\n"
    "var by=function(id){return document.getElementById(id)},pair=by('pair');\n"
    "if(!pair)return;\n"
    "function cut(){pair.style.setProperty('--cut',by('cut').value+'%')}\n"
    "function pictures(){by('over').style.backgroundImage='var(--'+by('left').value+')';by('under').style.backgroundImage='var(--'+by('right').value+')'}\n"
    "by('cut').addEventListener('input',cut);by('left').addEventListener('change',pictures);by('right').addEventListener('change',pictures);\n"
    "cut();pictures();\n"
    "if(location.hash!=='#selftest')return;\n"
    "var look=function(id){return getComputedStyle(by(id))},before=look('over').clipPath,picture=look('over').backgroundImage;\n"
    "by('cut').value=20;by('cut').dispatchEvent(new Event('input'));by('left').value='ref';by('left').dispatchEvent(new Event('change'));\n"
    "var fetched=performance.getEntriesByType('resource').filter(function(e){return e.name.slice(0,5)!=='data:'}).length;\n"
    "var drawn=document.querySelectorAll('svg .major circle,svg .major g path').length;\n"
    "document.documentElement.dataset.selftest=[before!==look('over').clipPath?'cut-moves':'cut-stays',\n"
    " picture!==look('over').backgroundImage&&look('over').backgroundImage.slice(0,9)==='url(\"data'?'picture-changes':'picture-stays',\n"
    " 'fetched-'+fetched,drawn>0?'drawn':'empty',by('over').getBoundingClientRect().width>100?'visible':'hidden'].join(' ');\n"
    "})();\n";
