"""Who may look and how much may come in: what every request passes first."""

from __future__ import annotations

import secrets
from http.cookies import SimpleCookie
from urllib.parse import parse_qs, urlsplit

from nicegui.app import App
from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

LOOPBACK = ("127.0.0.1", "localhost", "::1")
"""Hosts that only this machine reaches."""
MOST_BYTES = 10_000_000
"""Of an upload."""
_SLACK_BYTES = 100_000
"""What wraps an upload on its way."""

_COOKIE = "rigsim-studio"
_NO_TOKEN = "rigsim studio: open the whole link that the command printed; its token is missing or wrong.\n"
_OTHER_SITE = "rigsim studio: asked for under another name than the one it is served at.\n"
_TOO_LARGE = "rigsim studio: a file may have 10 MB at most.\n"
_POLICY = 1008


class Gate:
    """Stands before the page.

    Where only this machine can reach it, requests that another site's page makes are refused: they come
    under another name, or from another origin. Elsewhere a token is wanted, in the address or in the cookie
    that came of it. Nothing larger than an upload may be is read.
    """

    def __init__(self, inner: ASGIApp, token: str = "") -> None:
        """Stand before `inner`; without a token only this machine's own names are answered to."""
        self._inner = inner
        self._token = token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request, or one websocket."""
        if scope["type"] not in ("http", "websocket"):
            await self._inner(scope, receive, send)
            return
        headers = Headers(scope=scope)
        asked = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]
        if not _is_own(headers, any_host=bool(self._token)):
            await _refuse(_OTHER_SITE, 403, scope, receive, send)
        elif self._token and not (self._is_token(asked) or self._is_token(_cookie(headers))):
            await _refuse(_NO_TOKEN, 403, scope, receive, send)
        elif int(headers.get("content-length", "0") or 0) > MOST_BYTES + _SLACK_BYTES:
            await _refuse(_TOO_LARGE, 413, scope, receive, send)
        else:
            giving = self._giving_cookie(send) if self._token and self._is_token(asked) else send
            await self._inner(scope, _at_most(receive) if scope["type"] == "http" else receive, giving)

    def _is_token(self, text: str) -> bool:
        return secrets.compare_digest(text.encode(), self._token.encode())

    def _giving_cookie(self, send: Send) -> Send:
        cookie = f"{_COOKIE}={self._token}; Path=/; HttpOnly; SameSite=Strict"

        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                message = {**message, "headers": [*message["headers"], (b"set-cookie", cookie.encode())]}
            await send(message)

        return sent


def stand_before(app: App, token: str) -> None:
    """Let every request to `app` pass a `Gate`."""
    app.add_middleware(Gate, token=token)


def _is_own(headers: Headers, *, any_host: bool) -> bool:
    """Whether a request comes under a name of this machine, and from a page of the same name."""
    host = headers.get("host", "")
    name = urlsplit(f"//{host}").hostname or ""
    origin = headers.get("origin", "")
    same = not origin or urlsplit(origin).netloc == host
    return same and (any_host or name in LOOPBACK)


def _cookie(headers: Headers) -> str:
    held = SimpleCookie(headers.get("cookie", "")).get(_COOKIE)
    return "" if held is None else held.value


def _at_most(receive: Receive) -> Receive:
    """The same, ended as by a reader who has gone once too much has come."""
    read = 0

    async def received() -> Message:
        nonlocal read
        message = await receive()
        read += len(message.get("body", b""))
        return {"type": "http.disconnect"} if read > MOST_BYTES + _SLACK_BYTES else message

    return received


async def _refuse(says: str, status: int, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "http":
        await PlainTextResponse(says, status_code=status)(scope, receive, send)
    else:
        await send({"type": "websocket.close", "code": _POLICY})
