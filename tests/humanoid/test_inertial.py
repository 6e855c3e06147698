"""What separates a controller from its robot: an inertial unit that errs, and servos that obey late."""

from __future__ import annotations

import math

import numpy as np
from humanoid.control.prediction import Prediction
from humanoid.data import JointCommand
from humanoid.robot.model import GRAVITY, PERIOD, SERVO_DELAY, HumanoidModel
from humanoid.seeds import generator
from humanoid.sensing.attitude import AttitudeEstimator
from humanoid.simulation.inertial import MEMS, InertialErrors, InertialUnit
from humanoid.simulation.sim import Noise, Simulator
from humanoid.spatial import Array, matrix_of, rotation_rpy, rotation_vector, vector_of
from humanoid.trials.harness import Lockstep

BIAS = np.array([0.004, -0.006, 0.005])  # rad/s


def _error(estimator: AttitudeEstimator, truth: Array) -> Array:
    """The rotation vector (3,) by which an estimate is off, in the world [rad]."""
    return vector_of(matrix_of(estimator.orientation) @ truth.T)


def _turned(estimator: AttitudeEstimator, truth: Array, rates: Array, random: np.random.Generator) -> Array:
    """Feed rates of turn (n, 3) of a body, whose rotation this begins at; returns that at their end."""
    now = estimator.stamp or 0
    for number, rate in enumerate(rates):
        truth = truth @ rotation_vector(rate * PERIOD * 1e-9)
        felt = truth.T @ np.array([0.0, 0.0, GRAVITY]) + 0.05 * random.standard_normal(3)
        measured = rate + BIAS + 0.005 * random.standard_normal(3)
        estimator.update(now + (number + 1) * PERIOD, measured, felt)
    return truth


def test_finds_its_bias_and_its_tilt_at_rest() -> None:
    estimator, truth = AttitudeEstimator(), rotation_rpy(0.10, -0.05, 0.0)
    _turned(estimator, truth, np.zeros((2500, 3)), np.random.default_rng(1))
    assert np.abs(estimator.bias - BIAS).max() < 3e-4
    assert np.abs(_error(estimator, truth)).max() < 3e-3


def test_follows_a_body_that_turns() -> None:
    estimator, random = AttitudeEstimator(), np.random.default_rng(2)
    truth = _turned(estimator, np.eye(3), np.zeros((1250, 3)), random)
    time = np.arange(10_000)[:, None] * PERIOD * 1e-9
    rates = np.hstack((0.4 * np.cos(2 * time), 0.3 * np.sin(3 * time), np.full_like(time, 0.5)))
    truth = _turned(estimator, truth, rates, random)
    x, y, heading = _error(estimator, truth)
    assert math.hypot(x, y) < 5e-3
    assert abs(heading) < 2e-2  # of 20 rad


def test_gravity_bounds_the_tilt_but_not_the_heading() -> None:
    """The bias changes as the body moves, where only gravity can tell."""
    estimator, random = AttitudeEstimator(), np.random.default_rng(3)
    truth = _turned(estimator, np.eye(3), np.zeros((1250, 3)), random)
    time = np.arange(20_000)[:, None] * PERIOD * 1e-9
    rates = np.hstack((0.3 * np.cos(2 * time), 0.3 * np.sin(2 * time), 0.0 * time))
    drift = np.full(3, 0.001)
    now = (estimator.stamp or 0) + PERIOD
    for number, rate in enumerate(rates):
        truth = truth @ rotation_vector(rate * PERIOD * 1e-9)
        estimator.update(now + number * PERIOD, rate + BIAS + drift, truth.T @ np.array([0.0, 0.0, GRAVITY]))
    x, y, heading = _error(estimator, truth)
    assert math.hypot(x, y) < 0.02
    assert 0.06 < heading < 0.10  # 80 s of it


def test_readings_repeat() -> None:
    def readings(seed: int) -> list[Array]:
        unit = InertialUnit(MEMS, generator(seed, "imu"))
        found = [unit.read(n * PERIOD, np.zeros(3), np.array([0.0, 0.0, GRAVITY])) for n in range(5)]
        return [np.hstack((imu.orientation, imu.angular_velocity, imu.linear_acceleration)) for imu in found]

    first = readings(1)
    assert np.array_equal(first, readings(1))
    assert not np.allclose(first, readings(2))
    unit = InertialUnit(MEMS, generator(1, "imu"))
    at_once = [unit.read(0, np.zeros(3), np.array([0.0, 0.0, GRAVITY])) for _ in range(2)]
    assert at_once[0] is at_once[1]


def test_the_soles_correct_the_tilt(model: HumanoidModel) -> None:
    """An accelerometer with a bias takes 10 mrad for level; soles that lie flat know better."""
    errors = InertialErrors(acceleration_bias=0.1)
    robot = Lockstep(model, seed=1, noise=Noise(errors))
    robot.run(5.0)
    assert not robot.fell
    truth = robot.simulator.data.xmat[model.base].reshape(3, 3)
    assert robot.odometry is not None
    imu = robot.simulator.sensors().imu
    said, known = (
        vector_of(matrix_of(q) @ truth.T)[:2] for q in (imu.orientation, robot.odometry.orientation)
    )
    assert np.linalg.norm(said) > 5e-3
    assert np.linalg.norm(known) < 2e-3


def test_servos_obey_after_their_delay(model: HumanoidModel) -> None:
    simulator = Simulator(model)
    before = simulator.data.ctrl[model.actuators].copy()
    wanted = np.clip(before + 0.1, model.lower, model.upper)
    assert simulator.apply(JointCommand(0, wanted))
    obeyed = []
    while simulator.stamp < 10 * PERIOD:
        simulator.step()
        obeyed.append(bool(np.array_equal(simulator.data.ctrl[model.actuators], wanted)))
    assert obeyed.index(True) * PERIOD == SERVO_DELAY == 12_000_000
    assert all(obeyed[obeyed.index(True) :])


def test_the_controller_expects_what_it_commanded_and_a_push() -> None:
    prediction, com = Prediction(4.0, 0.004), np.array([0.0, 0.0])
    assert not prediction.gained(com, np.zeros(2), standing=True).any()
    for _ in range(5):
        prediction.press(np.array([-0.1, 0.0]))
    velocity = np.zeros(2)
    for _ in range(20):
        velocity = velocity + 0.004 * np.array([16.0 * 0.1, 0.0])
        ordinary = prediction.gained(com, velocity, standing=True)
    assert np.allclose(ordinary, [0.012 * 1.6, 0.0])
    for _ in range(20):
        velocity = velocity + 0.004 * np.array([1.6, 6.0])
        pushed = prediction.gained(com, velocity, standing=True)
    assert 0.012 * 3.5 < pushed[1] < 0.012 * 6.0
    assert np.allclose(prediction.gained(com, velocity, standing=False), ordinary)
