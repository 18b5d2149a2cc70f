"""What the comparisons with other codes share: running them in turn, medians, the table."""

import argparse
import json
import os
import re
import shlex
import shutil
import statistics
import subprocess
from pathlib import Path

root = Path(__file__).resolve().parents[2]
decks = root / "bench" / "peers"
work = root / "out" / "bench" / "peers"  # initial states, kept from run to run; programs run there
logs = root / "out" / "bench" / "peers_logs"


class Failed(Exception):
    pass


def call(command, log, environment=None):
    """Runs `command` among the initial states; what it prints goes into the log and back."""
    logs.mkdir(parents=True, exist_ok=True)
    path = logs / f"{log}.log"
    with open(path, "w") as out:
        out.write("$ " + shlex.join(map(str, command)) + "\n")
        out.flush()
        try:
            code = subprocess.run(command, cwd=work, stdin=subprocess.DEVNULL, stdout=out,
                                  stderr=subprocess.STDOUT, env={**os.environ, **(environment or {})}).returncode
        except OSError as problem:
            raise Failed(str(problem))
    text = path.read_text(errors="replace")
    if code != 0:
        raise Failed(f"exit {code}, see out/bench/peers_logs/{log}.log: {last_line(text)}")
    return text


def last_line(text):
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    wrong = [line for line in lines if "error" in line.lower()]
    return (wrong or lines or [""])[-1][:160]


def write_rows(path, rows):
    part = path.with_name(path.name + ".part")
    part.write_text("".join(" ".join(f"{x:.10g}" for x in row) + "\n" for row in rows))
    part.replace(path)


def pinned(threads):
    """One thread stays on one core, the same for all."""
    return ["taskset", "-c", str(sorted(os.sched_getaffinity(0))[-1])] if threads == 1 else []


def version_of(package, program):
    if not shutil.which(program):
        return None
    found = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True)
    return found.stdout if found.returncode == 0 else "of unknown version"


def flags_of_ours(set_name):
    for entry in json.loads((root / "build" / "release" / "compile_commands.json").read_text()):
        if entry["file"].endswith(f"bench/peers/{set_name}.cpp"):
            words = shlex.split(entry["command"])
            return " ".join(w for w in words if re.match(r"-(O|march|mtune|m|f|std)", w))
    return "unknown"


def processor():
    try:
        return re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())[1]
    except (OSError, TypeError):
        return "unknown processor"


# --- the comparison --------------------------------------------------------------------------------------


def compare(case, rivals, options, run_code):
    """Medians by code, contacts by code and failures by code, from runs in turn.

    `run_code(code, case, threads)` gives speed, contacts, and what else ours tells of itself.
    """
    speeds, contacts, failures, about = {}, {}, {}, {}
    for repeat in range(options.repeats):
        for rival in rivals or [None]:
            for code in filter(None, ("abrade", rival)):
                if code in failures:
                    continue
                try:
                    speed, touching, details = run_code(code, case, options.threads)
                except Failed as problem:
                    failures[code] = str(problem)
                    continue
                print(f"  {case} {repeat + 1}/{options.repeats} {code}: {speed:.3g}", flush=True)
                speeds.setdefault(code, []).append(speed)
                contacts[code] = touching
                about.update(details)
    medians = {code: statistics.median(s) for code, s in speeds.items() if code not in failures}
    return medians, contacts, failures, about


def row_of(unit, peers, medians):
    row = {"unit": unit}
    if "abrade" in medians:
        row["ours"] = medians["abrade"]
    row.update({peer: medians[peer] for peer in peers if peer in medians})
    rivals = [medians[peer] for peer in peers if peer in medians]
    if "ours" in row and rivals:
        row["ratio_to_fastest"] = row["ours"] / max(rivals)
    return row


def table(heading, peers, results, contacts, failures):
    print(f"\n{heading}; ratio: ours to the fastest peer")
    print(f"{'case':<22}" + "".join(f"{name:>20}" for name in ("ours", *peers)) + f"{'ratio':>8}")
    for case, row in results.items():
        cells = []
        for code in ("abrade", *peers):
            speed = row.get("ours" if code == "abrade" else code)
            if speed is not None:
                touching = contacts[case].get(code)
                cells.append(f"{speed:.3g}" + (f" ({touching})" if touching is not None else ""))
            else:
                cells.append("failed" if code in failures[case] else "-")
        ratio = row.get("ratio_to_fastest")
        print(f"{case:<22}" + "".join(f"{c:>20}" for c in cells) + (f"{ratio:>8.2f}" if ratio else f"{'-':>8}"))
    for case, problems in failures.items():
        for code, problem in problems.items():
            print(f"{case}: {code} failed: {problem}")


def listed(known):
    def parse(text):
        names = text.split(",")
        for name in names:
            if name not in known:
                raise argparse.ArgumentTypeError(f"'{name}' is none of {', '.join(known)}")
        return names
    return parse


def options_of_command_line(set_name, description, cases, peers):
    parser = argparse.ArgumentParser(prog=f"bench/peers/run {set_name}", description=description)
    parser.add_argument("--cases", type=listed(cases), default=list(cases), help="of " + ",".join(cases))
    parser.add_argument("--peers", type=listed(peers), default=list(peers), help="of " + ",".join(peers))
    parser.add_argument("--repeats", type=int, default=3, help="runs of each peer; ours runs before each (%(default)s)")
    parser.add_argument("--threads", type=int, choices=(1, 2), default=1, help="or ranks (%(default)s)")
    options = parser.parse_args()
    if options.repeats < 1:
        parser.error("--repeats must be at least 1")
    return options


def begin(set_name, description, cases, peers):
    """Options of the command line and the peers that are installed; says what runs on what."""
    options = options_of_command_line(set_name, description, cases, peers)
    work.mkdir(parents=True, exist_ok=True)
    print(processor() + f", {options.threads} thread{'s' if options.threads > 1 else ''}, load "
          f"{os.getloadavg()[0]:.1f} at the start")
    print(f"ours: {flags_of_ours(set_name)}")
    usable = []
    for peer in options.peers:
        version = version_of(peer, peers[peer])
        if version:
            usable.append(peer)
            print(f"{peer}: {version}, Debian's build: -O2 for any processor of its architecture")
        else:
            log = logs / f"install_{peer}.log"
            reason = last_line(log.read_text(errors="replace")) if log.exists() else ""
            print(f"{peer}: not installed, left out. {reason}")
    return options, usable


def speeds(unit, heading, cases, peers, options, usable, make_scene, run_code):
    """Compares the chosen cases and prints the table; rows by case and failures by case and code."""
    results, contacts, failures = {}, {}, {}
    for case in options.cases:
        if case not in cases:
            continue
        try:
            make_scene(cases[case]["scene"])
        except Failed as problem:
            print(f"{case}: no initial state: {problem}")
            failures[case], results[case], contacts[case] = {"abrade": str(problem)}, {"unit": unit}, {}
            continue
        medians, contacts[case], failures[case], about = compare(
            case, [p for p in usable if p in cases[case]], options, run_code)
        results[case] = row_of(unit, peers, medians)
        if about:
            closes = f", ledger residual {about['ledger_residual_relative']:.1e}" if "ledger_residual_relative" in about else ""
            print(f"  ours: {about['compiler']}, {about['instruction_set']}{closes}")
    if results:
        table(heading, peers, results, contacts, failures)
    return results, failures


def write(set_name, options, results):
    threads = "" if options.threads == 1 else f"_{options.threads}_threads"
    out = root / "out" / "bench" / f"peers_{set_name}{threads}.json"
    out.write_text(json.dumps(results, indent=2) + "\n")
    print(f"-> {out.relative_to(root)}")


def run_set(set_name, description, unit, heading, cases, peers, make_scene, run_code):
    """A whole comparison; `peers` are programs by Debian package. Returns the exit code."""
    options, usable = begin(set_name, description, cases, peers)
    results, failures = speeds(unit, heading, cases, peers, options, usable, make_scene, run_code)
    write(set_name, options, results)
    return 1 if any("abrade" in f for f in failures.values()) else 0
