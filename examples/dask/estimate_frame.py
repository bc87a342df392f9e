"""Estimates the delays of many logs as one Dask DataFrame, on a running cluster.

    pip install -r requirements.txt ../../python
    python estimate_frame.py 'logs/*.csv' --scheduler tcp://HOST:8786 --delays delays.parquet

Each log is a partition of the DataFrame, and a task that any worker may take. Logs and the
package `tauscope` must be on every worker. A log that cannot be used is reported and left out.
"""
import argparse
import sys

import dask.dataframe as dd
import pandas as pd
import tauscope
from distributed import Client

#: The columns of the result and their types, which Dask asks for before there is a result.
COLUMNS = {"log": "str", "joint": "str", "trial": "str", "i": "int64", "p": "int64",
           "delta": "float64", "delta_s": "float64"}
EMPTY = pd.DataFrame({name: pd.Series(dtype=kind) for name, kind in COLUMNS.items()})


def delays(log: pd.DataFrame) -> pd.DataFrame:
    """The accepted delays of one log, whose name is in the column `log`."""
    name = str(log["log"].iloc[0])
    try:
        found = tauscope.estimate(log.drop(columns="log"), progress=False).delays
    except tauscope.TauscopeError as error:
        print(f"{name}: {error}", file=sys.stderr)
        return EMPTY
    return found.assign(log=name).reindex(columns=list(COLUMNS)).astype(COLUMNS)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("logs", help="pattern of the logs, CSV with the same columns")
    parser.add_argument("--scheduler", help="address of a running cluster [default: one is started]")
    parser.add_argument("--delays", required=True, help="the table of all delays (Parquet)")
    args = parser.parse_args()
    with Client(args.scheduler):
        logs = dd.read_csv(
            args.logs, blocksize=None, include_path_column="log", assume_missing=True
        )
        found = logs.map_partitions(delays, meta=EMPTY).compute()
    found.reset_index(drop=True).to_parquet(args.delays)
    summary = found.groupby("joint")["delta_s"].describe(percentiles=[0.5])
    print(summary[["count", "min", "50%", "max"]].to_string())


if __name__ == "__main__":
    main()
