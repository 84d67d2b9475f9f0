"""``python -m vibralign``: the command ``vibralign``."""

import sys

from vibralign.commands.main import main

sys.exit(main())
