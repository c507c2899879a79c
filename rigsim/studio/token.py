"""Who may look, where other machines can reach the page: whoever has the link with its token."""

from __future__ import annotations

import secrets
from http.cookies import SimpleCookie
from urllib.parse import parse_qs

from nicegui.app import App
from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_COOKIE = "rigsim-studio"
_REFUSED = "rigsim studio: open the whole link that the command printed; its token is missing or wrong.\n"
_WEBSOCKET_REFUSED = 1008


class TokenGuard:
    """Lets a request through that brings the token, in its address or in the cookie that came of it."""

    def __init__(self, inner: ASGIApp, token: str) -> None:
        """Stand before `inner`."""
        self._inner = inner
        self._token = token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request, or one websocket."""
        if scope["type"] not in ("http", "websocket"):
            await self._inner(scope, receive, send)
            return
        asked = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]
        if self._is_token(asked):
            await self._inner(scope, receive, self._giving_cookie(send))
        elif self._is_token(_cookie(scope)):
            await self._inner(scope, receive, send)
        elif scope["type"] == "http":
            await PlainTextResponse(_REFUSED, status_code=403)(scope, receive, send)
        else:
            await send({"type": "websocket.close", "code": _WEBSOCKET_REFUSED})

    def _is_token(self, text: str) -> bool:
        return secrets.compare_digest(text.encode(), self._token.encode())

    def _giving_cookie(self, send: Send) -> Send:
        cookie = f"{_COOKIE}={self._token}; Path=/; HttpOnly; SameSite=Strict"

        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                message = {**message, "headers": [*message["headers"], (b"set-cookie", cookie.encode())]}
            await send(message)

        return sent


def require_token(app: App, token: str) -> None:
    """Let nobody in without `token`."""
    app.add_middleware(TokenGuard, token=token)


def _cookie(scope: Scope) -> str:
    held = SimpleCookie(Headers(scope=scope).get("cookie", "")).get(_COOKIE)
    return "" if held is None else held.value
