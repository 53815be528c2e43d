"""Runs a process engine and records what is said: record_conversation.py FILE COMMAND..."""
import json, subprocess, sys

engine = subprocess.Popen(sys.argv[2:], stdin=subprocess.PIPE, stdout=subprocess.PIPE, pass_fds=(3,))
with open(sys.argv[1], "ab") as record:
    for request in sys.stdin.buffer:
        engine.stdin.write(request)
        engine.stdin.flush()
        line = engine.stdout.readline()
        if not line:
            sys.exit(1)
        record.write(request + line)
        answer = json.loads(line)
        if "cpu" in answer:
            answer["cpu"] = 0  # that of this process is counted, not the engine's
        print(json.dumps(answer), flush=True)
