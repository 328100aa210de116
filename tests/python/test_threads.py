"""Threads, the interpreter lock, Ctrl-C, callbacks."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import pytest

import isochor as iso
from conftest import Block, Finger, sentence


def test_worlds_in_threads_have_the_bits_that_they_have_alone():
    def run(frames, out, k):
        made = Block()
        for _ in range(frames):
            made.world.advance(0.005)
        out[k] = made.world.state_hash

    alone, together = {}, {}
    for k in range(4):
        run(3 + k, alone, k)
    threads = [threading.Thread(target=run, args=(3 + k, together, k)) for k in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert together == alone


def test_a_step_releases_the_interpreter_lock(finger):
    finger.air.amount = 3000.0
    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1

    thread = threading.Thread(target=count)
    # With the lock held the other thread could count between steps only.
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        thread.start()
        before = counted[0]
        finger.world.advance(1 / 60)
        during = counted[0] - before
    finally:
        over.set()
        thread.join()
        sys.setswitchinterval(interval)
    assert during > 100


def test_one_world_in_two_threads_is_refused_with_a_sentence():
    made = Finger()
    inside, go_on = threading.Event(), threading.Event()

    def hold(progress):
        inside.set()
        go_on.wait(30)

    made.world.progress = hold
    made.air.amount = 2000.0
    thread = threading.Thread(target=lambda: made.world.advance(1 / 60))
    thread.start()
    assert inside.wait(30)
    for call in (
        lambda: made.world.advance(1 / 60),
        lambda: made.world.time,
        lambda: made.world.positions(made.body),
        lambda: made.world.save(),
        lambda: setattr(made.air, "amount", 1.0),
    ):
        with pytest.raises(iso.Error) as error:
            call()
        assert "another thread is in advance() of this world" in sentence(error)
    go_on.set()
    thread.join()
    made.world.progress = None
    assert made.world.advance(1 / 60).converged


def test_cancel_from_another_thread():
    made = Finger()
    inside = threading.Event()
    made.world.progress = lambda progress: inside.set()
    made.air.amount = 2000.0
    made.world.compile()
    before = made.world.state_hash

    def cancel():
        inside.wait(30)
        made.world.cancel()

    thread = threading.Thread(target=cancel)
    thread.start()
    with pytest.raises(iso.Cancelled) as error:
        for _ in range(100):
            made.world.advance(1 / 60)
    thread.join()
    assert error.value.report.status == "cancelled" and "cancelled" in sentence(error)
    assert before  # the world is usable
    made.world.progress = None
    assert made.world.advance(1 / 60).converged


def test_progress_is_told_once_an_iteration(finger):
    told = []
    finger.world.progress = told.append
    finger.air.amount = 1000.0
    report = finger.world.advance(1 / 60)
    assert len(told) == report.iterations > 0
    assert [p.iteration for p in told] == list(range(1, len(told) + 1))
    assert told[-1].target == pytest.approx(1 / 60) and told[-1].row_residual < told[0].row_residual
    finger.world.progress = None
    finger.world.advance(1 / 60)
    assert len(told) == report.iterations


def test_a_call_in_the_callback_is_refused_and_cancel_is_not(finger):
    said = []

    def meddle(progress):
        try:
            finger.world.advance(1 / 60)
        except iso.Error as error:
            said.append(str(error))
        finger.world.cancel()

    finger.air.amount = 3000.0
    finger.world.progress = meddle
    with pytest.raises(iso.Cancelled):
        finger.world.advance(1 / 60)
    assert len(said) == 1 and "called in a callback of advance()" in said[0] and "cancel()" in said[0]
    finger.world.progress = None
    assert finger.world.advance(1 / 60).converged


def test_what_a_callback_raises_cancels_the_step_and_is_raised(finger):
    finger.air.amount = 3000.0
    finger.world.compile()
    before = finger.world.state_hash

    def fail(progress):
        raise LookupError("of mine")

    finger.world.progress = fail
    with pytest.raises(LookupError, match="of mine"):
        finger.world.advance(1 / 60)
    assert finger.world.state_hash == before
    finger.world.progress = None
    assert finger.world.advance(1 / 60).converged


def test_a_callback_does_not_keep_its_world_alive():
    import gc
    import weakref

    made = Block()
    world = made.world
    world.progress = lambda progress: world
    world.advance(0.01)
    gone = weakref.ref(made.world)
    del made, world
    gc.collect()
    assert gone() is None


INTERRUPTED = textwrap.dedent(
    """
    import os, signal, sys, threading, time
    import isochor as iso
    world = iso.World(scheme="statics", threads=1)
    body = world.add_body(iso.box_mesh(divisions=(16, 16, 16)), iso.neo_hookean(young=1e5, poisson=0.5))
    world.add(iso.volume(body))
    world.add(iso.dirichlet(body, surfaces="z0", name="hold"))
    world.add(iso.dirichlet(body, surfaces="z1", name="pull", displacement=(0, 0, 0.4)))
    world.compile()
    before = world.state_hash
    started = []
    def interrupt():
        while not started:
            time.sleep(0.001)
        time.sleep(0.1)
        os.kill(os.getpid(), signal.SIGINT)
    threading.Thread(target=interrupt).start()
    start = time.time()
    started.append(1)
    try:
        world.advance(1)
        print("not interrupted after", time.time() - start)
    except KeyboardInterrupt:
        took = time.time() - start
        print("interrupted", took < 60, world.state_hash == before, world.time == 0.0)
    # The world is usable.
    world["pull"].amount = 1e-3
    print(world.advance(1e-3).status)
    """
)


def test_control_c_cancels_a_step_and_leaves_the_world_usable():
    done = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split("\n")[:2] == ["interrupted True True True", "converged"], done.stdout
