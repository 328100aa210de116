"""Studies: a scene over values of its parameters."""

from __future__ import annotations

import csv
import html
import itertools
import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Iterator, Mapping, Sequence

import numpy as np

from . import keys as _keys
from .errors import Error
from .scene import Run, Scene

Row = dict[str, Any]


class Study:
    """A table: a row a run, with its parameters, its status and the metrics of the scene.

    ``study["tip along"]`` is a column as an array, ``study.rows`` the table as dicts, ``study.runs`` the results.
    """

    def __init__(self, parameters: Sequence[str], rows: list[Row], runs: list[Run | None]) -> None:
        self.parameters = tuple(parameters)
        self.rows = rows
        self.runs = runs
        """None where the scene was refused; its row has the reason."""

    @property
    def columns(self) -> tuple[str, ...]:
        names: dict[str, None] = {}
        for row in self.rows:
            names.update(dict.fromkeys(row))
        return tuple(names)

    def __getitem__(self, column: str) -> np.ndarray:
        """A column, one entry a run; nan where a run has no such number."""
        if column not in self.columns:
            raise KeyError(f'no column is called "{column}"; there are: {", ".join(self.columns)}')
        values = [row.get(column) for row in self.rows]
        if all(isinstance(v, (int, float)) and not isinstance(v, bool) or v is None for v in values):
            return np.array([np.nan if v is None else float(v) for v in values])
        return np.array(values, dtype=object)

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the table, a line a run."""
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, self.columns)
            writer.writeheader()
            writer.writerows(self.rows)

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{html.escape(name)}</th>" for name in self.columns)
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(_shown(row.get(name)))}</td>" for name in self.columns) + "</tr>"
            for row in self.rows
        )
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

    def __repr__(self) -> str:
        return f"<isochor.Study: {len(self.rows)} runs over {', '.join(self.parameters)}>"


def study(
    scene: Scene | str | os.PathLike[str],
    over: Mapping[str, Sequence[Any]],
    *,
    together: bool = False,
    threads: int = 1,
    workers: int = 1,
    on_run: Callable[[int, int, Row], None] | None = None,
) -> Study:
    """Runs a scene for values of its parameters.

    ``over``: lists of values by their place in the scene, as in ``{"cavities.chamber.amount": [4e3, 8e3],
    "bodies[0].element": ["tet4", "tet10"]}``. Every combination is run; ``together``: the first values of all, then
    the second, ... ``threads``: of each run. ``workers``: runs at a time. ``on_run(done, runs, row)`` is called after
    each run. What a scene refuses or does not converge to is a row that says so, no exception.
    """
    base = scene if isinstance(scene, Scene) else Scene.load(scene)
    cases = _cases(over, together)

    def run(case: Row) -> tuple[Row, Run | None]:
        row: Row = dict(case)
        try:
            result = base.override(case).run(threads=threads, page=False)
        except Error as refused:
            row.update(status="refused", reason=str(refused))
            return row, None
        row.update(status=result.status, reason=result.reason)
        row.update({name: metric.value for name, metric in result.metrics.items() if metric.reached})
        return row, result

    rows: list[Row] = []
    runs: list[Run | None] = []

    def keep(row: Row, result: Run | None) -> None:
        rows.append(row)
        runs.append(result)
        if on_run is not None:
            on_run(len(rows), len(cases), row)

    if workers <= 1:
        for case in cases:
            keep(*run(case))
    else:
        with ThreadPoolExecutor(workers) as pool:
            pending = [pool.submit(run, case) for case in cases]
            try:
                for one in pending:
                    keep(*one.result())
            except BaseException:
                for one in pending:
                    one.cancel()
                raise
    return Study(list(over), rows, runs)


def _cases(over: Mapping[str, Sequence[Any]], together: bool) -> list[Row]:
    lists = {place: _keys.plain(values, f"study: {place}") for place, values in over.items()}
    for place, values in lists.items():
        if not isinstance(values, list) or not values:
            raise Error(f'study: "{place}" is {values!r}; give a list of values')
    if not lists:
        raise Error("study: nothing to vary; give lists of values by their place in the scene")
    if not together:
        return [dict(zip(lists, values)) for values in itertools.product(*lists.values())]
    lengths = {place: len(values) for place, values in lists.items()}
    if len(set(lengths.values())) != 1:
        raise Error(f"study: lists of different lengths {lengths}; together they must be of one length")
    return [dict(zip(lists, values)) for values in zip(*lists.values())]


def _shown(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else "" if value is None else str(value)
