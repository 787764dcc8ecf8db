"""The server: the page, its data over HTTP, and messages over the WebSocket."""
