"""The server as a page meets it: data over HTTP, and its port."""

from __future__ import annotations

import socket
from typing import Any

import numpy as np
import pytest
from palpate.base.errors import OptionError
from palpate.server.app import bind
from running_server import voxels

# --- http -------------------------------------------------------------------------------


@pytest.mark.parametrize("step", [1, 2, 3, 7, 41, 64])
def test_the_volume_arrives_with_every_step_th_voxel(shared_server: Any, step: int) -> None:
    array = shared_server.session.scene.volume.array
    got = voxels(shared_server, f"/api/volume?step={step}", "<i2")
    np.testing.assert_array_equal(got, array[::step, ::step, ::step])


@pytest.mark.parametrize("step", ["0", "-1", "65", "1.5", "x", "", "1" * 5000, "٣"])
@pytest.mark.parametrize("route", ["/api/volume", "/api/labels"])
def test_another_step_is_refused_with_what_is_allowed(
    shared_server: Any, route: str, step: str
) -> None:
    answer = shared_server.get(f"{route}?step={step}")
    assert answer.status_code == 400
    assert "allowed: a whole number 1 to 64" in answer.text


# --- ports ------------------------------------------------------------------------------


def test_a_port_in_use_is_refused() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(
            OptionError, match=f"port {port} cannot be used .* allowed: a free port"
        ):
            bind(port)


@pytest.mark.parametrize("port", [-1, 70000])
def test_what_is_no_port_is_refused(port: int) -> None:
    with pytest.raises(OptionError, match="allowed: a free port from 1 to 65535"):
        bind(port)


def test_the_server_listens_on_this_machine_only(server: Any) -> None:
    addresses = {str(info[4][0]) for info in socket.getaddrinfo(socket.gethostname(), None)}
    for address in addresses - {"127.0.0.1", "::1"}:
        family = socket.AF_INET6 if ":" in address else socket.AF_INET
        with socket.socket(family) as other:
            other.settimeout(1.0)
            assert other.connect_ex((address, server.access.port)) != 0
