-- SPDX-License-Identifier: BSD-2-Clause
-- Links of a page, for the static site: pages and sources have become .html, README.md the index.
function Link(link)
    if link.target:match("^%a+:") then return nil end
    local path, anchor = link.target:match("^([^#]*)(.*)$")
    path = path:gsub("README%.md$", "index.html"):gsub("%.md$", ".html")
    if path ~= "" and not path:match("%.html$") and not path:match("%.png$") and not path:match("%.svg$") and not path:match("%.gif$") and not path:match("/$") then path = path .. ".html" end
    link.target = path .. anchor
    return link
end

-- A formula scrolls in a box of its own: not every browser scrolls a <math>. So does one in a line of text, if a telephone is too narrow for it.
function Math(m)
    if m.mathtype == "DisplayMath" then return pandoc.Span({m}, {class = "formula"}) end
    if #m.text > 30 then return pandoc.Span({m}, {class = "long"}) end
end
