# Writes all headers that are its arguments into few files: `to`/1.cxx, `to`/2.cxx, ..., the longest first. A header stands
# below others only where it includes all of them before its own text: it still compiles as if it were alone, and what
# they share is read once.

FNR == 1 { headers[FILENAME]; own = 0 }
/^namespace/ { own = 1 }
/^#include <abrade\// && !own { gsub(/^#include <|>.*/, ""); takes[FILENAME] = takes[FILENAME] " " $0 }

function visit(of, header,    list, n) {  # what `of` takes in, itself too
    if ((of, header) in within) return
    within[of, header]; ++size[of]
    for (n = split(takes[header], list); n; --n) visit(of, list[n])
}
function largest(above,    header, found) {  # the one that takes in most, of those left that `above` takes in, or of all
    for (header in headers)
        if ((!above || (above, header) in within) && (!found || size[header] > size[found])) found = header
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
