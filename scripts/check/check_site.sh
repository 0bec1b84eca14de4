#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_site: is the static site whole in a real browser? No link of a page leads nowhere, no picture is missing,
# nothing is wider than a screen of 360 pixels, mathematics is typeset.
#     scripts/check/check_site.sh BROWSER SITE
# One page with a frame of 360 pixels opens every page of the site in turn and looks at it; a twin with one defect
# of each kind must be found out.
browser=$1
site=$(cd "$2" && pwd) || exit 1
profile=$(mktemp -d) || exit 1
trap 'rm -rf "$profile" "$site/check.html" "$site/twin.html"' EXIT

# harness PAGES...: what is wrong with them, one line each, then how many pages, links, pictures and formulas were
# seen
look() {
    {
        printf '<!DOCTYPE html><meta charset="utf-8"><body><pre id="r"></pre><script>const pages=['
        printf '"%s",' "$@"
        cat <<'SCRIPT'
];
const out = [], seen = {pages: 0, links: 0, pictures: 0, formulas: 0}, known = {};
const exists = url => known[url] ??= new Promise(done => {
    const x = new XMLHttpRequest();
    x.onload = () => done(x.responseText);
    x.onerror = () => done(null);
    x.open("GET", url);
    x.send();
});
async function look(page) {
    const frame = document.createElement("iframe");
    frame.style = "width:360px;height:640px;border:0";
    frame.src = page;
    document.body.append(frame);
    await new Promise(done => frame.onload = done);
    const d = frame.contentDocument, here = frame.contentWindow.location.href.replace(/#.*/, "");
    seen.pages++;
    for (const img of d.images) {
        seen.pictures++;
        if (!img.naturalWidth) out.push(page + ": no picture " + img.getAttribute("src"));
    }
    seen.formulas += d.querySelectorAll("math").length;
    if (d.documentElement.scrollWidth > 360) out.push(page + ": " + d.documentElement.scrollWidth + " pixels wide");
    for (const a of d.querySelectorAll("a[href]")) {
        if (!a.href.startsWith("file:")) continue;
        seen.links++;
        const [url, id] = a.href.split("#"), there = await exists(url);
        if (there === null) out.push(page + ": no " + a.getAttribute("href"));
        else if (id && !(url == here ? d.getElementById(decodeURIComponent(id))
            : there.includes('id="' + decodeURIComponent(id) + '"')))
            out.push(page + ": no place " + a.getAttribute("href"));
    }
    frame.remove();
}
(async () => {
    for (const page of pages) await look(page);
    r.textContent = "BEGIN\n" + out.join("\n") + "\nSEEN " + JSON.stringify(seen) + "\nEND";
})();
</script>
SCRIPT
    } >"$site/check.html"
    "$browser" --headless --no-sandbox --disable-gpu --user-data-dir="$profile" --no-first-run \
        --disable-background-networking --allow-file-access-from-files --host-resolver-rules="MAP * ~NOTFOUND" \
        --virtual-time-budget=120000 \
        --dump-dom "file://$site/check.html" 2>/dev/null |
        sed -n '/BEGIN$/,/^END/p' | sed '/BEGIN$/d; /^END/d; /^$/d'
}

cd "$site" || exit 1
cat >twin.html <<'EOT'
<!DOCTYPE html><meta charset="utf-8"><body><a href="nowhere.html">x</a><a href="index.html#nowhere">y</a>
<img src="nothing.png">
<div style="width:500px">wide</div>
EOT
found=$(look twin.html)
for defect in "no nowhere.html" "no place index.html#nowhere" "no picture nothing.png" "pixels wide"; do
    echo "$found" | grep -q "twin.html: .*$defect" || {
        echo "check_site: FAILED: a page with \"$defect\" passes: $found"
        exit 1
    }
done
rm -f twin.html
found=$(look $(find . -name '*.html' ! -name '*.[ch].html' ! -name '*.js.html' ! -name '*.sh.html' \
    ! -name '*.awk.html' ! -name '*.txt.html' ! -name '*.py.html' ! -name '*.ipynb.html' ! -name check.html \
    ! -name Makefile.html ! -name LICENSE.html ! -name CITATION.cff.html | sed 's|^\./||' | sort))
echo "$found" | grep -q '^SEEN .*"formulas":[1-9]' || {
    echo "check_site: FAILED: not all pages were seen, or none with mathematics: $found"
    exit 1
}
if echo "$found" | grep -qv '^SEEN'; then
    echo "$found"
    echo "check_site: FAILED"
    exit 1
fi
echo "check_site: passed: $found"
