"""asyncio and threads."""

import asyncio
import concurrent.futures
import queue
import signal
import subprocess
import sys
import threading
import time

import helper  # noqa: F401


async def child():
    script = "print('from a child')"
    process = await asyncio.create_subprocess_exec(sys.executable, "-c", script, stdout=subprocess.PIPE)
    return (await process.communicate())[0]


async def main():
    loop = asyncio.get_running_loop()
    asked = asyncio.Event()
    loop.add_signal_handler(signal.SIGUSR1, asked.set)
    signal.raise_signal(signal.SIGUSR1)
    await asyncio.wait_for(asked.wait(), 10)
    print(loop.remove_signal_handler(signal.SIGUSR1))
    print(await asyncio.gather(*(asyncio.sleep(0.01, n) for n in range(3))))
    print(await asyncio.to_thread(lambda: threading.current_thread() is threading.main_thread()))
    print(await child())
    try:
        await asyncio.wait_for(asyncio.sleep(30), 0.01)
    except TimeoutError as error:
        print("timeout", error)
    return "done"


print(asyncio.run(main()))
with concurrent.futures.ThreadPoolExecutor(2) as pool:
    print(sorted(pool.map(lambda n: n * n, range(4))))
left = concurrent.futures.ThreadPoolExecutor(1)  # never shut down
print(left.submit(threading.current_thread).result() is not threading.current_thread())
items = queue.Queue()
threading.Timer(0.05, items.put, ["an item"]).start()
print(items.get(timeout=10), items.empty())
try:
    items.get(timeout=0.1)
except queue.Empty:
    print("empty")
event = threading.Event()
began = time.monotonic()
print(event.wait(0.12), 0.1 < time.monotonic() - began < 10)
time.sleep(0.12)
condition = threading.Condition()
with condition:
    print(condition.wait(0.01))
thread = threading.Thread(target=time.sleep, args=(0.3,), name="sleeper")
thread.start()
thread.join(0.01)
print(thread.is_alive(), thread.name)
thread.join()
print(thread.is_alive(), subprocess.check_output([sys.executable, "-c", "print(1)"]))
