"""What a console and a notebook show of studies."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from loadshare.view import View, by_name, figure, listed

if TYPE_CHECKING:
    from loadshare.study.compare import Comparison
    from loadshare.study.critical import Critical
    from loadshare.study.fit import Fit
    from loadshare.study.march import March
    from loadshare.study.sensitivity import Sensitivity
    from loadshare.study.sweep import Sweep
    from loadshare.study.tolerance.result import Tolerance


def sweep_view(found: Sweep) -> View:
    """Show the grid, what became of its points, and the largest Ω at each."""
    grids = zip(found.parameters, found.grids, strict=True)
    facts = [
        (p.name, f"{values[0]:g} to {values[-1]:g} {p.unit}".rstrip() + f", {len(values)} values")
        for p, values in grids
    ]
    counts = Counter(p.status for p in found.points)
    facts.append(("points", ", ".join(f"{count} {status}" for status, count in counts.items())))
    rows = tuple(
        (
            *(f"{v:g}" for v in point.values),
            point.status,
            by_name(found.largest("omega", k))
            if point.status in ("certified", "partly refused")
            else point.message.partition("\n")[0],
        )
        for k, point in enumerate(found.points)
    )
    heads = (f"{p.name} [{p.unit}]" if p.unit else p.name for p in found.parameters)
    columns = (*heads, "status", "largest Ω")
    return View(f"Sweep of {found.case}", tuple(facts), columns, rows)


def critical_view(found: Critical) -> View:
    """Show the interval, what is not proved, and the events."""
    unit = found.parameter.unit
    facts = (
        (found.parameter.name, f"{found.start:g} to {found.stop:g} {unit}".rstrip()),
        ("events", f"{len(found.events)}, {sum(e.confirmed for e in found.events)} confirmed"),
        ("not proved", f"{len(found.unproved)} intervals" if found.unproved else "nothing"),
    )
    rows = tuple(
        (f"{e.value:.6g} {e.unit}".rstrip(), str(e.position), e.element, e.kind)
        for e in found.events
    )
    return View("Critical values", facts, ("value", "position", "element", "event"), rows)


def sensitivity_view(found: Sensitivity) -> View:
    """Show the largest derivatives of Ω of the system, and what a reader must know of them."""

    def cell(key: str, side: str, factor: float) -> str:
        rate = found.omega[key, side].get("system")
        error = found.omega_error[key, side].get("system", 0.0)
        if rate is None or rate != rate:
            return "–"
        return f"{rate * factor:+.4g}" if abs(rate) > error else f"0 ± {error * factor:.1g}"

    def size(key: str, factor: float) -> float:
        rates = [abs(found.omega[key, s].get("system", 0.0)) for s in found.sides]
        return max((r * abs(factor) for r in rates if r == r), default=0.0)

    order = sorted(found.inputs, key=lambda i: -size(i.key, i.value.factor))
    rows = tuple(
        (i.key, *(cell(i.key, s, i.value.factor) for s in found.sides), f"per {i.value.unit or 1}")
        for i in order
    )
    facts = (
        ("positions", listed(found.positions)),
        ("inputs", f"{len(found.inputs)}, {len(found.skipped)} left out"),
        ("on the verge", f"{len(found.kinks)} positions" if found.kinks else ""),
        ("remarks", str(len(found.remarks)) if found.remarks else ""),
    )
    columns = ("input", *(f"dΩ {side}" for side in found.sides), "unit")
    return View("Sensitivities of Ω of the system, largest first", facts, columns, rows)


def tolerance_view(found: Tolerance) -> View:
    """Show how many samples have an answer, the distribution of Ω, and the worst case found."""
    certified = f"{found.samples - found.refused} of {found.samples}"
    facts = (
        ("certified", f"{certified} samples, largest residual {found.residual:.1e}"),
        ("inputs", listed([one.name for one in found.inputs.every])),
        ("worst found", ", ".join(f"Ω {w.omega:.4f} over the {w.over}" for w in found.worst)),
        ("why refused", "; ".join(f"{n} × {m}" for m, n in found.messages.items())),
    )
    rows = []
    for one in found.omega:
        mean, beyond = one.summary.mean, one.exceedance
        rows.append(
            (
                one.stage,
                one.over,
                f"{mean.value:.4f} ({mean.low:.4f} to {mean.high:.4f})",
                figure(one.summary.spread),
                f"{beyond.value:.3g} ({beyond.low:.2g} to {beyond.high:.2g})" if beyond else "–",
            )
        )
    limit = "limit" if found.limit is None else f"{found.limit:g}"
    columns = ("stage", "over", "mean Ω (95 %)", "deviation", f"P(Ω > {limit})")
    return View(f"Tolerance study of {found.case}", facts, columns, tuple(rows))


def march_view(found: March) -> View:
    """Show how far the march went, how load was shared, and what the splines dissipated."""
    result, steps = found.result, len(found.revolutions)
    last = found.revolutions[-1] if steps else 0.0
    facts = (
        ("way", f"{steps} steps, {last:g} revolutions of gear {found.gear}"),
        ("certified", f"all steps, worst residual {result.certificate.worst:.1e}"),
        ("largest Ω", by_name(result.omega)),
        ("dissipated", f"{found.dissipated:.4g} J"),
    )
    rows = tuple(
        (
            gear,
            ", ".join(f"{n} {stage}" for stage, n in Counter(s.stage for s in every).items()),
            f"{sum(s.dissipated for s in every):.4g}",
        )
        for gear in (found.slips[0] if found.slips else ())
        for every in ([step[gear] for step in found.slips],)
    )
    columns = ("spline", "steps", "dissipated [J]")
    return View(f"March of {result.stamp.case}", facts, columns, rows)


def comparison_view(found: Comparison) -> View:
    """Show measured against computed figures."""
    chi = f"{found.chi_square:.4g} of {len(found.deviations)} figures"
    rows = tuple(
        (
            d.target.key + (f" at {d.target.position}" if d.target.position else ""),
            f"{d.target.value:g} ± {d.target.uncertainty:g} {d.target.unit}".rstrip(),
            f"{d.computed:.5g}",
            f"{d.deviations:+.2f}",
        )
        for d in found.deviations
    )
    columns = ("figure", "measured", "computed", "in deviations")
    title = f"Measured against computed, {found.result.stamp.case}"
    return View(title, (("χ²", chi),), columns, rows)


def fit_view(found: Fit) -> View:
    """Show the fitted inputs, how well they fit, and what the data leave open."""
    degrees = "1 degree" if found.freedom == 1 else f"{found.freedom} degrees"
    facts = (
        ("χ²", f"{found.chi_square:.4g}, {degrees} of freedom"),
        ("starts", f"{len(found.starts)}, {found.evaluations} sets of equilibria"),
        ("mind", " ".join(found.warnings)),
    )
    rows = tuple(
        (
            u.parameter.name,
            f"{u.value:.5g} ± {u.deviation:.2g} {u.parameter.unit}".rstrip(),
            f"{u.low:g} to {u.high:g}",
        )
        for u in found.unknowns
    )
    return View(f"Fit of {found.case.name}", facts, ("input", "value", "between"), rows)
