"""Sweeps as tasks on the workers of a Dask client."""

from __future__ import annotations

import json
import os
import socket
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
_LOOK = 1.0  # seconds between two looks at whether the sweep goes on
_PATIENCE = 60.0  # seconds for which stopped tasks are waited for

# Code of the process of a task: the program, which gets SIGTERM and saves its state if the worker that started it ends.
_TASK = """
import ctypes, os, signal, sys
worker = int(sys.argv.pop(1))
ctypes.CDLL(None).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG
if os.getppid() != worker:
    sys.exit(75)
from hardbody.__main__ import main
sys.exit(main())
"""


class TaskStopped(RuntimeError):
    """A task has ended without its runs being done: another attempt continues them."""


def known_workers(client: Any) -> int | None:
    """Returns the number of tasks that the workers of a client run at once; None if it has no workers yet."""
    return sum(client.nthreads().values()) or None


def run_task(directory: str, task: int, mark: str, *_after: int) -> int:
    """Runs a task of a sweep's plan in a process of its own. Returns 0, 1 if a run has failed, or 75 if the sweep was
    stopped: `mark`, a file in the directory, is gone then.

    It is called by workers, on which hardbody is installed and which see the directory under the same name.
    """
    file = Path(directory) / "sweep.toml"
    if not file.exists():
        raise TaskStopped(f"{file} is not there on {socket.gethostname()}; accepted: a directory that all workers see")
    command = [sys.executable, "-c", _TASK, str(os.getpid()), "sweep", "point", str(file), str(task)]
    standing = Path(directory) / mark
    for _ in range(_ATTEMPTS):
        if not _stands(standing):
            return _TRY_AGAIN
        status, said = _ended([*command, "--out", directory], standing)
        if status in (_DONE, _FAILED):
            return status
        if status != _TRY_AGAIN:
            break
        time.sleep(_PAUSE)
    if not _stands(standing):
        return _TRY_AGAIN
    raise TaskStopped(f"task {task} ended with {status}: {said.strip()[-1000:]}")


def _stands(mark: Path) -> bool:
    """Returns whether the file is there, as far as the file system tells."""
    try:
        return mark.exists()
    except OSError:
        return True


def _ended(command: list[str], mark: Path) -> tuple[int, str]:
    """Runs a command, which is stopped when the file is gone. Returns its exit status and what it has said."""
    told = False
    with subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        while True:
            try:
                said = process.communicate(timeout=_LOOK)[1]
                return process.returncode, said
            except subprocess.TimeoutExpired:
                if not told and not _stands(mark):
                    process.terminate()
                    told = True


def run_tasks(client: Any, directory: str, plan: str, progress: Progress | None) -> list[str]:
    """Runs the tasks of a plan. Returns messages of tasks that could not be completed.

    An exception, Ctrl-C for one, stops the tasks, which save their states, and is raised once they have ended.
    """
    tasks = json.loads(plan)["tasks"]
    mark = Path(directory) / f"dask.{time.time_ns()}"
    mark.touch()
    futures: dict[int, Any] = {}
    try:
        for task in tasks:
            after = [futures[k] for k in task["after"]]
            key = f"hardbody-{Path(directory).name}-{task['id']}-{time.time_ns()}"
            futures[task["id"]] = client.submit(
                run_task, directory, task["id"], mark.name, *after, key=key, pure=False, retries=_RETRIES
            )
        _watch(list(futures.values()), progress)
    except BaseException:
        mark.unlink(missing_ok=True)
        _stop(client, list(futures.values()))
        raise
    finally:
        mark.unlink(missing_ok=True)
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


def _stop(client: Any, futures: list[Any]) -> None:
    """Waits until the tasks, which have been told to stop, have ended, and withdraws those that have not."""
    end = time.monotonic() + _PATIENCE
    try:
        while not all(future.done() for future in futures) and time.monotonic() < end:
            time.sleep(0.1)
    finally:
        client.cancel(futures)
