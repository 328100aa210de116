# The compiled module. What is public of it is said by the files that use it.
from typing import Any

def __getattr__(name: str) -> Any: ...
