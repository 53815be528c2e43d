"""Runs a process engine and records what is said: record_conversation.py FILE COMMAND..."""
import subprocess, sys

engine = subprocess.Popen(sys.argv[2:], stdin=subprocess.PIPE, stdout=subprocess.PIPE, pass_fds=(3,))
with open(sys.argv[1], "ab") as record:
    for request in sys.stdin.buffer:
        engine.stdin.write(request)
        engine.stdin.flush()
        answer = engine.stdout.readline()
        if not answer:
            sys.exit(1)
        record.write(request + answer)
        sys.stdout.buffer.write(answer)
        sys.stdout.buffer.flush()
