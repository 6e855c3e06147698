"""Starts processes."""

import multiprocessing
import os
import signal
import sys
import time
import warnings

import helper


def work(results):
    results.put((__name__, sys.argv[1:], helper.WHO, type(sys.argv).__name__))
    results.put(signal.getsignal(signal.SIGTERM) == signal.SIG_DFL)


if __name__ == "__main__":
    for method in ("fork", "spawn"):
        context = multiprocessing.get_context(method)
        results = context.Queue()
        child = context.Process(target=work, args=(results,))
        child.start()
        print(method, results.get(timeout=30), results.get(timeout=30))
        child.join()
        print(child.exitcode)
    child = multiprocessing.get_context("fork").Process(target=time.sleep, args=(30,))
    child.start()
    child.terminate()
    child.join()
    print("terminated", child.exitcode == -signal.SIGTERM)
    sys.stdout.flush()
    warnings.simplefilter("ignore")  # about threads during the fork
    if not os.fork():
        print("forked", flush=True)
        sys.exit(5)
    print(os.waitstatus_to_exitcode(os.wait()[1]))
