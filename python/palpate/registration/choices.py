"""What can be chosen of a registration."""

from __future__ import annotations

from typing import Literal, get_args

__all__ = ["KINDS", "METRICS", "STARTS", "Kind", "Metric", "MetricChoice", "Start"]

Kind = Literal["rigid", "affine", "bspline"]
Metric = Literal["mutual-information", "correlation", "mean-squares"]
MetricChoice = Literal["automatic", "mutual-information", "correlation", "mean-squares"]
"""Automatic is the correlation of two scans by CT, else mutual information."""
Start = Literal["geometry", "centre", "moments", "landmarks"]
KINDS: tuple[Kind, ...] = get_args(Kind)
METRICS: tuple[MetricChoice, ...] = get_args(MetricChoice)
STARTS: tuple[Start, ...] = get_args(Start)
