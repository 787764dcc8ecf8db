"""``python -m palpate``: the command line."""

from palpate.cli import main

main()
