# SPDX-License-Identifier: MIT
"""Engines that execute the runs of a sweep: local processes, Dask, or Slurm. Each engine is a generator that yields the
result of a job as soon as it is there. Lost runs are retried; a job runs at most kTries times."""
import concurrent.futures
import json
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import time

import run
from plan import Wrong
from results import put

kTries = 5
kSlurmTasks = 1000  # Slurm's own limit of an array is 1,001 by default
kPoll_s = 1.0


def lost_too_often(job, why):
    return dict(run.empty_result(job), ended="lost", error=f"lost {kTries} times: {why}")


def local(jobs, processes, carry_out=run.run_one):
    """Processes on this machine, `processes` at a time. `carry_out(job, started)` does a job."""
    started = run.Started()
    # An exception from a signal handler could leave a lock of the pool locked. Killed runs end the wait below instead.
    handlers = {number: signal.signal(number, lambda *_: started.kill()) for number in (signal.SIGINT, signal.SIGTERM)}
    with concurrent.futures.ThreadPoolExecutor(processes) as pool:
        waiting = list(reversed(jobs))
        tries = {}
        running = {}
        try:
            while waiting or running:
                while waiting and len(running) < processes and not started.killed:
                    job = waiting.pop()
                    running[pool.submit(carry_out, job, started)] = job
                if started.killed and not running:  # all of them had just ended
                    raise KeyboardInterrupt
                # With a timeout: a signal just before the wait does not end it.
                done, _ = concurrent.futures.wait(running, kPoll_s, concurrent.futures.FIRST_COMPLETED)
                for future in done:
                    job = running.pop(future)
                    try:
                        yield future.result()
                    except run.Lost as lost:
                        if started.killed:
                            raise KeyboardInterrupt from None
                        tries[job["key"]] = tries.get(job["key"], 0) + 1
                        if tries[job["key"]] < kTries:
                            waiting.append(job)
                        else:
                            yield lost_too_often(job, lost)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            started.kill()
            for number, handler in handlers.items():
                signal.signal(number, handler)


def dask(jobs, address, processes):
    """The workers of a Dask scheduler; `address` "local" starts a cluster on this machine."""
    try:
        import distributed
    except ImportError:
        raise Wrong("--dask needs Dask: apt-get install python3-distributed (and the same on the workers)") from None
    cluster = None
    space = tempfile.TemporaryDirectory(prefix="coopdyn-dask-")
    try:
        if address == "local":
            cluster = distributed.LocalCluster(n_workers=processes, threads_per_worker=1, dashboard_address=None, local_directory=space.name)
        client = distributed.Client(cluster or address, timeout=15)
    except (OSError, ValueError) as error:
        space.cleanup()
        raise Wrong(f"no Dask scheduler answers at {address} ({error}): write --dask tcp://HOST:8786 of one, or --dask local") from None
    try:
        client.upload_file(run.__file__)
        tries = {}
        # Dask reassigns the runs of a killed worker; a run that kills its workers ends as KilledWorker.
        by_key = {job["key"]: job for job in jobs}
        submit = lambda job: client.submit(run.run_one, job, key=f"{job['key']}-{tries.get(job['key'], 0)}", pure=False)
        futures = distributed.as_completed([submit(job) for job in jobs])
        for future in futures:
            job = by_key[future.key.rpartition("-")[0]]
            if future.status == "finished":
                yield future.result()
                future.release()
                continue
            error = future.exception()
            tries[job["key"]] = tries.get(job["key"], 0) + 1
            if tries[job["key"]] < kTries:
                futures.add(submit(job))
            else:
                yield lost_too_often(job, error)
    finally:
        client.close()
        if cluster:
            cluster.close()
        space.cleanup()


def _command(words):
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise Wrong(f"--slurm needs Slurm's command {words[0]}, which is not on the PATH of this machine") from None
    if done.returncode != 0:
        raise Wrong(f"{words[0]} failed: {(done.stderr or done.stdout).strip()}")
    return done.stdout.strip()


def slurm(jobs, options, folder, wait=True):
    """Arrays of a Slurm cluster whose nodes see `folder` and the program. `options`: further arguments of sbatch."""
    place = os.path.join(os.path.abspath(folder), "slurm")
    answers = os.path.join(place, "results")
    os.makedirs(answers, exist_ok=True)
    missing = dict((job["key"], job) for job in jobs)
    yield from _collect(answers, missing)
    for number in range(kTries):
        if not missing:
            return
        array = _running_array(place)
        if array is None:
            array = _submit(list(missing.values()), options, place, answers)
        if not wait:
            print(f"Slurm has array {array}. Run the same command again to collect what is there.", file=sys.stderr)
            return
        while _is_queued(array):
            time.sleep(kPoll_s)
            yield from _collect(answers, missing)
        yield from _collect(answers, missing)
        os.remove(os.path.join(place, "array"))
    for job in missing.values():
        yield lost_too_often(job, "see " + place)


def _submit(jobs, options, place, answers):
    size = -(-len(jobs) // kSlurmTasks)
    chunks = [jobs[i:i + size] for i in range(0, len(jobs), size)]
    todo = os.path.join(place, f"todo-{time.time_ns()}.jsonl")
    with open(todo, "x", encoding="utf-8") as stream:
        stream.writelines(json.dumps(chunk) + "\n" for chunk in chunks)
    task = " ".join(shlex.quote(word) for word in [sys.executable, run.__file__, todo]) + f' "$SLURM_ARRAY_TASK_ID" {shlex.quote(answers)}'
    array = _command(["sbatch", "--parsable", "--requeue", "--job-name", "coopdyn-sweep", f"--array=0-{len(chunks) - 1}",
                      "--output", os.path.join(place, "task-%A_%a.log"), *shlex.split(options), "--wrap", task])
    put(os.path.join(place, "array"), array.partition(";")[0])
    return array.partition(";")[0]


def _running_array(place):
    """A still running array of an earlier, killed sweep; None if none."""
    try:
        with open(os.path.join(place, "array"), encoding="utf-8") as stream:
            array = stream.read().strip()
    except OSError:
        return None
    return array if array and _is_queued(array) else None


def _is_queued(array):
    done = subprocess.run(["squeue", "--noheader", "--array", "--jobs", array], capture_output=True, text=True, check=False)
    if done.returncode != 0 and "Invalid job id" not in done.stderr:
        raise Wrong(f"squeue failed: {done.stderr.strip()}")
    return bool(done.stdout.strip())


def _collect(answers, missing):
    for name in sorted(os.listdir(answers)):
        key, ending = os.path.splitext(name)
        if ending != ".json" or key not in missing:
            continue
        with open(os.path.join(answers, name), encoding="utf-8") as stream:
            result = json.load(stream)
        del missing[key]
        yield result
