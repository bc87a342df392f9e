"""Runs `tauscope estimate` over a folder of logs on a Dask cluster.

    pip install -r requirements.txt
    python estimate_folder.py LOGS --results FOLDER --decisions all.csv [--workers N] [-- OPTIONS]

Each worker takes a part of the logs (`--shard`); the command without it then makes the table, which
is that of one process, byte for byte. Without --scheduler a cluster is started on this
machine. Options after `--` go to `tauscope estimate`. The folders must be reachable by the
same paths from every worker.
"""
import argparse
import subprocess
import sys

from distributed import Client, LocalCluster, as_completed


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0],
                                     epilog="Options after -- go to tauscope estimate.")
    parser.add_argument("logs", help="folder of logs")
    parser.add_argument("--results", required=True, help="folder where results are kept")
    parser.add_argument("--decisions", required=True, help="the table of all decisions")
    parser.add_argument("--workers", type=int, default=4, help="parts, one per worker")
    parser.add_argument("--scheduler", help="address of a running scheduler")
    parser.add_argument("--tauscope", default="tauscope", help="the program")
    own, options = sys.argv[1:], []
    if "--" in own:
        place = own.index("--")
        own, options = own[:place], own[place + 1 :]
    args = parser.parse_args(own)
    args.options = options
    return args


def part(number, args):
    """Works on one part of the logs; what failed is in the answer, beside the part's number."""
    command = [args.tauscope, "estimate", args.logs, "--results", args.results, "--quiet",
               "--threads", "1", "--shard", f"{number}/{args.workers}", *args.options]
    done = subprocess.run(command, capture_output=True, text=True)
    return number, done.returncode, done.stderr


def main():
    args = arguments()
    if args.scheduler:
        cluster = args.scheduler
    else:
        cluster = LocalCluster(n_workers=args.workers, threads_per_worker=1, dashboard_address=None)
    worst = 0
    with Client(cluster) as client:
        # Parts are not pure functions: what is on the disk may have changed.
        parts = client.map(part, range(1, args.workers + 1), args=args, pure=False)
        for future in as_completed(parts):
            number, status, errors = future.result()
            print(f"part {number} of {args.workers}: status {status}", file=sys.stderr)
            sys.stderr.write(errors)
            worst = max(worst, status)
    if worst > 1:
        return worst
    whole = [args.tauscope, "estimate", args.logs, "--results", args.results, *args.options,
             "--decisions", args.decisions]
    return max(worst, subprocess.run(whole).returncode)


if __name__ == "__main__":
    sys.exit(main())
