"""Python's logging, configured as programs do."""

import logging
import sys
import warnings

import helper  # noqa: F401

logger = logging.getLogger("robot")
print(logger.level, logger.handlers, logging.getLogger().handlers, logger.isEnabledFor(logging.ERROR))
logger.error("before anything is configured")
logging.basicConfig(
    level=logging.DEBUG, format="%(levelname)s %(name)s %(threadName)s %(module)s: %(message)s"
)
print(len(logging.getLogger().handlers), logging.getLogger().level, logger.getEffectiveLevel())
logging.debug("root")
logger.info("child")
logging.getLogger("robot.arm").warning("grandchild")
extra = logging.StreamHandler(sys.stdout)
logger.addHandler(extra)
logger.propagate = False
logger.setLevel(logging.WARNING)
logger.info("nobody hears this")
logger.warning("on stdout alone")
logger.addFilter(lambda record: "secret" not in record.getMessage())
logger.error("a secret")
logging.disable(logging.WARNING)
logger.warning("disabled")
logging.disable(logging.NOTSET)
try:
    1 / 0  # noqa: B018
except ZeroDivisionError:
    logging.exception("as it happened")
warnings.warn("be warned", stacklevel=1)
print(logging.getLogger("asyncio").level)
