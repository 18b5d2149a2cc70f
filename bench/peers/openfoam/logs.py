"""What a run of OpenFOAM printed and wrote."""

import re

number = r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)"


def steps(log):
    """Of each step: seconds of the processor so far, dt [s], time-weighted mean of |div u| (dt times it, the last
    that the step printed), cycles of the pressure solver."""
    found, dt = [], None
    fixed = re.search(r"^deltaT\s*=?\s*" + number, log, re.MULTILINE)
    for block in re.split(r"^Time = ", log, flags=re.MULTILINE)[1:]:
        seconds = re.search(r"ExecutionTime = " + number + " s", block)
        local = re.findall(r"continuity errors : sum local = " + number, block)
        cycles = re.findall(r"Solving for p(?:_rgh)?, .*No Iterations (\d+)", block)
        if seconds:
            found.append({"seconds": float(seconds[1]), "sum_local": float(local[-1]) if local else None,
                          "pressure_cycles": sum(map(int, cycles))})
    return found


def water_volumes(log):
    """Mean of the phase fraction after each step."""
    return [float(v) for v in re.findall(r"Phase-1 volume fraction = " + number, log)]


def values(path):
    """The inner values of a field in ASCII: numbers, or lists of three."""
    text = path.read_text()
    body = text[text.index("internalField"):]
    if re.match(r"internalField\s+uniform", body):
        raise ValueError(f"{path} is uniform")
    body = body[body.index("(") + 1:body.index("\n)\n")]
    if "(" in body:
        return [[float(x) for x in row] for row in re.findall(r"\(" + r"\s+".join([number] * 3) + r"\)", body)]
    return [float(x) for x in body.split()]
