"""The class of the warnings on a device: of commands, which print them, and of Python."""


class DoubtWarning(UserWarning):
    """A value of a device that is possible but probably not meant, or an answer to distrust."""
