"""The exception that every refused call raises."""

import re


class InvalidInput(ValueError):
    """Bad input; nothing was changed by the call.

    field: what is wrong, as "BodyDefinition.mass"; None where the message has another form.
    value: what it was, as text.
    expected: the valid range, as text.
    """

    def __init__(self, message):
        super().__init__(message)
        parts = re.fullmatch(r"(\S+) is (.*); expected (.*)", message, re.DOTALL)
        self.field, self.value, self.expected = parts.groups() if parts else (None, None, None)
