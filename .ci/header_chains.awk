# Writes all headers that are its arguments into as few files as may be: `to`/1.cxx, `to`/2.cxx, ... A header stands below
# others only where it takes in all of them: it still compiles as if it were alone, and what they share is read once.

FNR == 1 { headers[FILENAME]; body = 0 }
/^#ifndef ABRADE_COMPILED/ { body = 1 }  # which abrade::compiled has
/^#endif/ { body = 0 }
/^#include <abrade\// && !body { gsub(/^#include <|>.*/, ""); takes[FILENAME] = takes[FILENAME] " " $0 }

function visit(of, header,    list, n) {  # what `of` takes in, itself too
    if ((of, header) in within) return
    within[of, header]; ++size[of]
    for (n = split(takes[header], list); n; --n) visit(of, list[n])
}
function largest(of,    header, found) {  # of those left that `of` takes in, or of all
    for (header in headers)
        if ((!of || (of, header) in within) && (!found || size[header] > size[found])) found = header
    return found
}
END {
    for (header in headers) visit(header, header)
    while (header = largest()) {
        for (chain = ""; header; header = largest(last)) {
            chain = "#include <" header ">\n" chain
            last = header
            delete headers[header]
        }
        printf "%s", chain >(to "/" ++files ".cxx")
    }
}
