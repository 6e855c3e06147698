"""Ends in the way that its argument names, with output from threads, exit functions and errors."""

import atexit
import os
import signal
import sys
import threading
import time

import helper  # noqa: F401


def later(text, seconds=0.1):
    time.sleep(seconds)
    print(text)


def failing():
    raise ValueError("in a thread")


how = sys.argv[1]
atexit.register(print, "registered first, called last")
atexit.register(later, "called second", 0)


@atexit.register
def first():
    print("called first", threading.current_thread() is threading.main_thread())


def never():
    print("never called")


atexit.register(never)
atexit.unregister(never)
print(threading.current_thread().name, threading.main_thread() is threading.current_thread(), how)
print(threading.active_count(), len(threading.enumerate()), threading.current_thread().daemon)
threading.Thread(target=later, args=("a thread is waited for",)).start()
threading.Thread(target=later, args=("a daemon is not", 30), daemon=True).start()
sys.stdout.flush()
thread = threading.Thread(target=failing)
print(thread.name, thread.daemon)
thread.start()
thread.join()
sys.stderr.flush()

if how == "end":
    pass
elif how == "none":
    sys.exit()
elif how == "number":
    sys.exit(3)
elif how == "negative":
    sys.exit(-1)
elif how == "large":
    sys.exit(256 + 5)
elif how == "text":
    sys.exit("no luck")
elif how == "object":
    raise SystemExit({"reason": 0.1})
elif how == "error":

    def broken():
        raise RuntimeError("broken") from ZeroDivisionError("cause")

    broken()
elif how == "import":
    pass
elif how == "interrupt":
    raise KeyboardInterrupt
elif how == "hook":
    sys.excepthook = lambda kind, error, trace: print("hook:", kind.__name__, error, trace.tb_lineno > 0)
    threading.excepthook = lambda args: print("thread hook:", args.exc_value)
    thread = threading.Thread(target=failing)
    thread.start()
    thread.join()
    raise LookupError("hooked")
elif how == "atexit":
    atexit.register(lambda: 1 / 0)
elif how == "exit now":
    sys.stdout.flush()
    os._exit(4)
elif how == "exit now in a thread":
    sys.stdout.flush()
    threading.Thread(target=os._exit, args=(5,)).start()
    time.sleep(30)
elif how == "kill":
    sys.stdout.flush()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(30)
elif how == "thread exits":
    thread = threading.Thread(target=sys.exit, args=(9,))
    thread.start()
    thread.join()
    print("only that thread has ended")
else:
    sys.exit(f"unknown: {how}")
