"""The yardstick's side of `poligon bench flight`: times JSBSim's own steps, by its own clock.

A line on stdin is `MODEL STEPS`; the answer is nanoseconds a step, then those of a call that does nothing, which are the
price of the binding. The first line out is the version. A model is made on first use and flies on from line to line.
"""
import sys
import time

import jsbsim

RATE_HZ = 120


def light():
    """The package's light aircraft in level flight, engine running, trimmed."""
    f = jsbsim.FGFDMExec(None)
    f.set_debug_level(0)
    f.load_model("c172x")
    # The model writes a file a run otherwise.
    f.disable_output()
    f.set_dt(1 / RATE_HZ)
    f["ic/h-sl-ft"], f["ic/vc-kts"] = 3000, 100
    f.run_ic()
    f["propulsion/set-running"] = -1
    f["fcs/mixture-cmd-norm"], f["fcs/throttle-cmd-norm"] = 0.87, 0.7
    f["simulation/do_simple_trim"] = 1
    return f


def bomb():
    """The package's bomb, dropped from where it takes minutes to land."""
    f = jsbsim.FGFDMExec(None)
    f.set_debug_level(0)
    f.load_model("mk82")
    f.disable_output()
    f.set_dt(1 / RATE_HZ)
    start(f)
    return f


def start(f):
    f["ic/h-sl-ft"], f["ic/u-fps"] = 60000, 700
    f.run_ic()


made = {}
# The library greets on file descriptor 1; answers go where that was.
answers = sys.stdout
print(jsbsim.__version__, file=answers, flush=True)
for line in sys.stdin:
    model, steps = line.split()
    if model not in made:
        made[model] = {"c172x": light, "mk82": bomb}[model]()
    f, steps = made[model], int(steps)
    if model == "mk82":
        start(f)
    run, nothing = f.run, f.get_sim_time
    begin = time.perf_counter_ns()
    for _ in range(steps):
        run()
    middle = time.perf_counter_ns()
    for _ in range(steps):
        nothing()
    end = time.perf_counter_ns()
    print("answer", (middle - begin) / steps, (end - middle) / steps, file=answers, flush=True)
