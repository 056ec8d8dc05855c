"""Sweeps as tasks on the workers of a Dask client."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from hardbody._typing import Progress

_DONE = 0
_FAILED = 1
_TRY_AGAIN = 75
_PAUSE = 5.0  # seconds between two attempts of a task
_ATTEMPTS = 60  # for which a run that another process works on is waited for
_RETRIES = 20  # of a task that was stopped


class TaskStopped(RuntimeError):
    """A task has ended without its runs being done: another attempt continues them."""


def run_task(directory: str, task: int, *_after: int) -> int:
    """Runs a task of a sweep's plan in a process of its own. Returns 0, or 1 if a run has failed.

    It is called by workers, on which hardbody is installed and which see the directory under the same name.
    """
    file = str(Path(directory) / "sweep.toml")
    command = [sys.executable, "-m", "hardbody", "sweep", "point", file, str(task), "--out", directory]
    for _ in range(_ATTEMPTS):
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        if done.returncode in (_DONE, _FAILED):
            return done.returncode
        if done.returncode != _TRY_AGAIN:
            break
        time.sleep(_PAUSE)
    raise TaskStopped(f"task {task} ended with {done.returncode}: {done.stderr.strip()[-1000:]}")


def run_tasks(client: Any, directory: str, plan: str, progress: Progress | None) -> list[str]:
    """Runs the tasks of a plan. Returns messages of tasks that could not be completed."""
    tasks = json.loads(plan)["tasks"]
    futures: dict[int, Any] = {}
    for task in tasks:
        after = [futures[k] for k in task["after"]]
        key = f"hardbody-{Path(directory).name}-{task['id']}-{time.time_ns()}"
        futures[task["id"]] = client.submit(
            run_task, directory, task["id"], *after, key=key, pure=False, retries=_RETRIES
        )
    try:
        _watch(list(futures.values()), progress)
    except BaseException:
        client.cancel(list(futures.values()))
        raise
    return [f"task {k}: {future.exception()}" for k, future in futures.items() if future.status != "finished"]


def _watch(futures: list[Any], progress: Progress | None) -> None:
    """Waits for all tasks."""
    while True:
        over = sum(future.done() for future in futures)
        if progress is not None:
            progress(f"sweep on Dask: {over} of {len(futures)} tasks done", over / len(futures) if futures else 1.0)
        if over == len(futures):
            return
        time.sleep(0.25)
