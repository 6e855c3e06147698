"""What a node logs, in another process, which sets its level."""

from rcl_interfaces.msg import Log, LoggerLevel
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from rclpy.qos import DurabilityPolicy, QoSProfile
from stage import Stage


def speaker(stage: Stage) -> None:
    """Logs."""
    node = stage.node("speaker", namespace="/here", enable_logger_service=True)

    def speak(word):
        logger = node.get_logger()
        logger.debug(f"{word} debug")
        logger.info(f"{word} info")
        logger.get_child("part").info(f"{word} of a part")
        logger.warning(f"{word} warning")
        logger.error(f"{word} error")
        logger.fatal(f"{word} fatal")

    speak("early")
    for word in ("first", "second", "third"):
        stage.meet()
        speak(word)
    stage.meet()


def listener(stage: Stage) -> None:
    """Hears, and sets the level."""
    node = stage.node("listener")
    heard = []
    node.create_subscription(
        Log,
        "/rosout",
        lambda log: heard.append((log.name, log.level, log.msg, log.function, log.stamp.sec > 0)),
        QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL),
    )
    levels = node.create_client(SetLoggerLevels, "/here/speaker/set_logger_levels")
    asking = node.create_client(GetLoggerLevels, "/here/speaker/get_logger_levels")
    stage.until(lambda: levels.service_is_ready() and asking.service_is_ready())
    stage.until(lambda: any(text == "early fatal" for _, _, text, *_ in heard))
    name = "here.speaker"
    for level in (None, 40, 10):
        if level is not None:
            request = SetLoggerLevels.Request(levels=[LoggerLevel(name=name, level=level)])
            stage.say([result.successful for result in stage.result(levels.call_async(request)).results])
        answer = stage.result(asking.call_async(GetLoggerLevels.Request(names=[name, "nobody"])))
        stage.say([(each.name, each.level) for each in answer.levels])
        stage.meet()
        word = {None: "first", 40: "second", 10: "third"}[level]
        stage.until(lambda word=word: any(text == f"{word} fatal" for _, _, text, *_ in heard))
    stage.spin(0.1)
    for each in heard:
        if each[0].startswith("here"):
            stage.say(*each)
    stage.meet()


ROLES = {
    "speaker": speaker,
    "listener": listener,
}
