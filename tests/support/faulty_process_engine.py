"""The engine that `plumb new-engine --process` writes, with one fault: faulty_process_engine.py FOLDER FAULT."""
import json, os, signal, subprocess, sys, time

folder, fault = sys.argv[1:]
engine = subprocess.Popen(["python3", folder + "/engine.py"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
previous = None
held = []

def say(text):
    sys.stdout.write(text)
    sys.stdout.flush()

def burn(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass

if fault == "before-hello":
    sys.exit("no licence")
for line in sys.stdin:
    request = json.loads(line)
    engine.stdin.write(line)
    engine.stdin.flush()
    answer = json.loads(engine.stdout.readline())
    kind = request["request"]
    if "cpu" in answer:
        answer["cpu"] = 0  # that of this process is counted, not the engine's
    if kind == "hello":
        if fault == "fewer-profiles" and not os.path.exists("started"):
            open("started", "w").close()
            answer["profiles"] = [{"name": "default"}, {"name": "second"}]
        if fault == "hang-in-hello":
            time.sleep(100)
        if fault == "other-protocol":
            answer["protocol"] = "plumb.engine/9"
        if fault == "option-range":
            answer["options"][0]["value"] = -5
        if fault == "half-substep":
            answer["substeps"] = 2.7
        if fault == "busy-start":
            burn(1)
        if fault == "unknown-capability":
            answer["capabilities"].append("joints")
    if kind == "create" and fault == "unsupported":
        answer = {"id": request["id"], "error": "no spheres on Tuesdays", "unsupported": True}
    if kind == "create" and fault == "error":
        answer = {"id": request["id"], "error": "the world is full"}
    if kind == "create" and fault == "half-substep-read":
        answer["settings"]["substeps"] = 2.7
    if kind == "create" and fault == "error-object":
        answer = {"id": request["id"], "error": {"message": "the world is full"}}
    if kind == "create" and fault == "no-reason":
        answer["unsupported"] = True
    if kind == "create" and fault == "unsupported-text":
        answer["unsupported"] = "yes"
    if kind == "step" and fault == "step-leak" or kind == "create" and fault == "scene-leak":
        held.append(b"x" * (1 << 16))
    if kind == "step" and fault in ("too-much-time-each", "busy-start"):
        answer["cpu"] = 0.005
    if kind == "step" and request["step"] == 3:
        if fault == "signal":
            os.kill(os.getpid(), signal.SIGSEGV)
        if fault == "exit":
            print("out of pencils", file=sys.stderr)
            sys.exit(7)
        if fault == "hang":
            time.sleep(100)
        if fault == "burn":
            burn(100)
        if fault == "garbage":
            say("Hello world\n")
        if fault == "half-a-line":
            say('{"id": ')
            sys.exit(0)
        if fault == "half-and-hang":
            say('{"id": ')
            time.sleep(100)
        if fault == "flood":
            while True:
                say("x" * 65536)
        if fault == "lines":
            while True:
                say('{"id": 1}\n' * 1000)
        if fault == "twice":
            say(json.dumps(answer) + "\n")
        if fault == "late":
            answer = previous
        if fault == "short-frame":
            answer["frame"].pop()
        if fault == "nan":
            answer["frame"][2] = float("nan")
        if fault == "null":
            answer["frame"][2] = None
        if fault == "text-in-frame":
            answer["frame"][2] = "high"
        if fault == "beyond-the-file":
            answer["frame"] = {"offset": 1000000, "count": len(answer["frame"])}
        if fault == "half-an-offset":
            answer["frame"] = {"offset": 0.5, "count": len(answer["frame"])}
        if fault == "half-a-count":
            answer["frame"] = {"offset": 0, "count": len(answer["frame"]) + 0.5}
        if fault == "numbers-memory":
            for mib in range(300):
                os.pwrite(3, bytes(1 << 20), mib << 20)
        if fault == "long-answer":
            say('{"note": "')
            for mib in range(200):
                say("x" * (1 << 20))
            say('", ' + json.dumps(answer)[1:] + "\n")
            continue
        if fault == "stats-array":
            answer["stats"] = [1, 2]
        if fault == "contact-of-nobody":
            answer["contacts"] = [0, 99, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0]
        if fault == "odd-contacts":
            answer["contacts"] = [0, 1, 0]
        if fault == "too-much-time":
            answer["cpu"] = 1000
        if fault == "negative-time":
            answer["cpu"] = -1
        if fault == "no-time":
            del answer["cpu"]
        if fault == "memory":
            held += [bytearray(1 << 20) for _ in range(1 << 14)]
        if fault == "detached":
            subprocess.Popen(["sleep", "321"], start_new_session=True)
        if fault == "grandchild":
            subprocess.Popen(["sleep", "321"])
            sys.exit(0)
    previous = answer
    say(json.dumps(answer) + "\n")
if fault == "deaf":
    time.sleep(100)
engine.kill()
