"""Who is let in: by host and origin on this machine, by a token elsewhere; and how much may come in."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from rigsim.studio.gate import MOST_BYTES, Gate

TOKEN = "correct-horse"


def _ask(gate_token: str, query: str = "", chunks: int = 0, kind: str = "http", **headers: str) -> Any:
    """What a request gets: the messages sent back, and how much the page behind has read."""
    sent: list[dict[str, Any]] = []
    read = 0

    async def page(_: Any, receive: Any, send: Any) -> None:
        nonlocal read
        while True:
            message = await receive()
            read += len(message.get("body", b""))
            if message["type"] == "http.disconnect" or not message.get("more_body"):
                break
        await send({"type": "http.response.start", "status": 200, "headers": []})

    left = chunks

    async def receive() -> dict[str, Any]:
        nonlocal left
        left -= 1
        return {"type": "http.request", "body": b"x" * 1_000_000 * (chunks > 0), "more_body": left > 0}

    async def send(message: Any) -> None:
        sent.append(message)

    scope = {
        "type": kind,
        "query_string": query.encode(),
        "headers": [(name.replace("_", "-").encode(), value.encode()) for name, value in headers.items()],
    }
    asyncio.run(Gate(page, gate_token)(scope, receive, send))
    return sent, read


def _status(sent: list[dict[str, Any]]) -> int:
    return int(sent[0].get("status") or sent[0].get("code") or 0)


@pytest.mark.parametrize("host", ["127.0.0.1:8080", "localhost:8080", "[::1]:8080"])
def test_this_machine_s_own_names_are_answered_to(host: str) -> None:
    sent, _ = _ask("", host=host, origin=f"http://{host}")
    assert _status(sent) == 200


@pytest.mark.parametrize(
    "headers",
    [
        {"host": "evil.example:8080"},
        {"host": "127.0.0.1:8080", "origin": "http://evil.example"},
        {"host": "127.0.0.1:8080", "origin": "http://127.0.0.1:9999"},
        {},
    ],
)
def test_pages_of_other_sites_are_not(headers: dict[str, str]) -> None:
    assert _status(_ask("", **headers)[0]) == 403
    assert _ask("", kind="websocket", **headers)[0] == [{"type": "websocket.close", "code": 1008}]


def test_elsewhere_a_token_is_wanted_and_kept_in_a_cookie() -> None:
    host = "rig.example:8080"
    assert _status(_ask(TOKEN, host=host)[0]) == 403
    assert _status(_ask(TOKEN, query="token=wrong", host=host)[0]) == 403
    assert _status(_ask(TOKEN, kind="websocket", host=host)[0]) == 1008
    sent, _ = _ask(TOKEN, query=f"focal=900&token={TOKEN}", host=host)
    assert _status(sent) == 200
    ((name, cookie),) = sent[0]["headers"]
    assert name == b"set-cookie"
    assert b"HttpOnly" in cookie
    sent, _ = _ask(TOKEN, host=host, cookie=cookie.decode().split(";")[0])
    assert _status(sent) == 200
    assert sent[0]["headers"] == []


def test_nothing_larger_than_an_upload_is_read() -> None:
    host = "127.0.0.1:8080"
    assert _status(_ask("", host=host, content_length=str(2 * MOST_BYTES))[0]) == 413
    _, read = _ask("", chunks=40, host=host)  # of no length that was told
    assert read <= MOST_BYTES + 1_000_000
    assert _ask("", chunks=5, host=host)[1] == 5_000_000
