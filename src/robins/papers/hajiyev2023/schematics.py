"""Two drawings without data: what a differenced measurement holds, and how the filters of the study relate."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from robins.papers.hajiyev2023.variants import VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

PRINTED, CORRECTED = style.VERMILLION, style.GREEN
EPOCHS = {"k-1": 2.3, "k": 5.3, "k+1": 8.3}
ROWS = {"time": 6.55, "state": 5.7, "measurement": 4.5, "difference": 3.4, "printed": 2.0, "corrected": 0.6}


def canvas(height: float, xlim: tuple[float, float], ylim: tuple[float, float]) -> tuple[Drawing, Axes]:
    """A drawing of full width without axes."""
    figure = Drawing(figsize=(style.WIDTH, height))
    ax = figure.subplots()
    ax.set(xlim=xlim, ylim=ylim)
    ax.axis("off")
    return figure, ax


def node(ax: Axes, x: float, y: float, text: str, color: str = style.BLACK, **changes) -> None:
    """A boxed text."""
    box = {"boxstyle": "round,pad=0.35", "facecolor": "white", "edgecolor": color, "linewidth": 0.9}
    look = {"horizontalalignment": "center", "verticalalignment": "center", "fontsize": 9, "color": color, "zorder": 3}
    ax.text(x, y, text, bbox=box, **look | changes)


def arrow(ax: Axes, start, end, text: str = "", color: str = style.GREY, above: float = 0.17, width: float = 1.0, shrink=(14, 14)) -> None:
    """An arrow that leaves `shrink` points free at either node, with `text` above its middle."""
    look = {"arrowstyle": "-|>", "color": color, "linewidth": width, "shrinkA": shrink[0], "shrinkB": shrink[1], "mutation_scale": 9}
    ax.annotate("", end, start, arrowprops=look, zorder=2)
    ax.text((start[0] + end[0]) / 2, (start[1] + end[1]) / 2 + above, text, color=color, fontsize=8.5, horizontalalignment="center")


def draw_differencing(results: Results) -> Drawing:
    """A time line: the noise that state and difference share, and the two places where C has been put."""
    figure, ax = canvas(4.7, (-0.2, 10.2), (0.0, 7.35))
    for row, words in (("state", "state"), ("measurement", "measurement"), ("difference", "difference")):
        ax.text(-0.15, ROWS[row], words, fontsize=8.5, color=style.GREY, verticalalignment="center")
    draw_signals(ax)
    draw_filter_row(ax, ROWS["printed"], "filter\nas printed", PRINTED, at_update=True)
    draw_filter_row(ax, ROWS["corrected"], "filter\ncorrected", CORRECTED, at_update=False)
    return figure


def draw_signals(ax: Axes) -> None:
    """Upper half: states, measurements and differences, with the path of w(k) into mu(k)."""
    state, measured, differenced = ROWS["state"], ROWS["measurement"], ROWS["difference"]
    places = list(EPOCHS.items())
    for name, x in places:
        shared = name == "k+1"
        color = PRINTED if shared else style.BLACK
        ax.text(x, 7.2, f"${name}$", fontsize=8.5, color=style.GREY, horizontalalignment="center", verticalalignment="center")
        ax.plot([x, x], [2.9, 7.0], color=style.GREY, linewidth=0.4, linestyle=":", zorder=0)
        node(ax, x, state, f"$x({name})$")
        node(ax, x, measured, f"$z({name})$")
        arrow(ax, (x, state), (x, measured), color=color if shared else style.GREY, width=1.8 if shared else 1.0)
    for (name, x), (_, following) in zip(places[:-1], places[1:], strict=True):
        middle, shared = (x + following) / 2, name == "k"
        color, width = (PRINTED, 1.8) if shared else (style.GREY, 1.0)
        arrow(ax, (x, state), (following, state), shrink=(19, 28) if shared else (28, 19))
        node(ax, middle, 6.6, f"$G\\,w({name})$", PRINTED if shared else style.BLACK)
        arrow(ax, (middle, 6.6), (following - 0.1, state), color=color, width=width)
        node(ax, middle, differenced, f"$\\mu({name})$", PRINTED if shared else style.BLACK)
        arrow(ax, (x, measured), (middle, differenced), "$-A_n$", above=-0.32)
        arrow(ax, (following, measured), (middle, differenced), color=color, width=width)
    ax.text(9.0, 3.62, "$w(k)$ is in $\\mu(k)$:\n$C=E[Gw(k)\\,\\xi^T(k)]$", fontsize=8.5, color=PRINTED, horizontalalignment="center",
            verticalalignment="center")  # fmt: skip


def draw_filter_row(ax: Axes, y: float, words: str, color: str, at_update: bool) -> None:
    """Prediction, update with mu(k) and next prediction, with C at the place that one form of the filter gives it."""
    ax.text(-0.15, y, words, fontsize=8.5, color=color, verticalalignment="center")
    before, after, following = (3.3, y), (6.6, y), (9.3, y)
    node(ax, *before, r"$\hat{x}(k/k-1)$")
    node(ax, *after, r"$\hat{x}(k/k)$")
    node(ax, *following, r"$\hat{x}(k+1/k)$")
    update = ("update with $\\mu(k)$\n$+\\,C$: (14), (16), (18)", PRINTED) if at_update else ("update with $\\mu(k)$", style.GREY)
    step = ("time step", style.GREY) if at_update else ("time step\n$+\\,C$", CORRECTED)
    for (start, end), (text, tint) in zip(((before, after), (after, following)), (update, step), strict=True):
        marked = tint != style.GREY
        arrow(ax, start, end, text, tint, above=0.14, width=1.8 if marked else 1.0,
              shrink=(36, 26) if end is after else (26, 36))  # fmt: skip
    note = "this error holds $w$ up to $k-1$ only" if at_update else "this step adds $w(k)$, which $\\mu(k)$ has seen"
    ax.text(before[0] - 0.5 if at_update else after[0] - 0.35, y - 0.52, note, fontsize=8, color=style.GREY)


READS = {"printed": r"$\mu(k)$", "corrected": r"$\mu(k)$", "late": r"$\mu(k-1)$ as if $\mu(k)$"}
CORRELATED_ERROR = {"classical": "ignored", "augmented": "eight more states", "oracle": "eight more states"}
CROSS = {"printed": "update", "late": "update", "corrected": "prediction"}
SCALED = {"printed": "all of $R$", "late": "all of $R$", "corrected": "$R_v$ only", "augmented": "$Q_v$", "oracle": "$Q_v$"}
RULES = {"per-channel": "each channel its own", "gated": "each, if significant", "scalar-trace": "one for all, trace",
         "scalar-mean": "one for all, mean"}  # fmt: skip
COLUMNS = ((0.0, "filter"), (2.95, "reads"), (4.8, r"error $\lambda$"), (6.7, "$C$ enters"), (7.95, "scale factors"),
           (10.35, "on"))  # fmt: skip


def cells(composition: dict) -> tuple[str, ...]:
    """What the columns after the first say about a filter's composition."""
    form, rule = composition["form"], composition.get("rule", "")
    error = "in $R$" if composition.get("inflated") else CORRELATED_ERROR.get(form, "differenced away")
    factors = "told the fault" if form == "oracle" else RULES.get(rule, "1")
    scaled = SCALED[form] if rule or form == "oracle" else "–"
    return READS.get(form, "$z(k)$"), error, CROSS.get(form, "–"), factors, scaled


STEPS = ((0.75, "measurement"), (0.58, "innovation\n$\\Delta$"), (0.46, "weights\n$w_i = 1/s_i$"),
         (0.94, "noise\n$R^{1/2}\\,\\mathrm{diag}(1/w)\\,R^{1/2}$"), (0.42, "update"), (0.56, "prediction"))  # fmt: skip
"""Steps of the one update, with the half-widths of their boxes."""


def draw_steps(ax: Axes, y: float, width: float) -> None:
    """The one update from left to right, and back from the prediction to the next innovation."""
    gap = (width - 2 * sum(half for half, _ in STEPS)) / (len(STEPS) - 1)
    edge, places = 0.0, []
    for half, text in STEPS:
        node(ax, edge + half, y, text, fontsize=8.5)
        places.append(edge + half)
        edge += 2 * half + gap
        if len(places) < len(STEPS):
            arrow(ax, (edge - gap + 0.06, y), (edge - 0.06, y), shrink=(0, 0))
    low = y - 1.05
    ax.plot([places[-1], places[-1], places[1]], [y - 0.45, low, low], color=style.GREY, linewidth=1.0)
    arrow(ax, (places[1], low), (places[1], y - 0.62), shrink=(0, 0))


def draw_filters(results: Results) -> Drawing:
    """The one update above, and below it what each filter of the registry puts into its places."""
    count = len(VARIANTS)
    figure, ax = canvas(5.0, (-0.1, 11.4), (-0.6, count + 3.4))
    draw_steps(ax, count + 2.5, 11.3)
    for x, words in COLUMNS:
        ax.text(x, count + 0.25, words, fontsize=8.5, fontweight="bold", verticalalignment="center")
    ax.plot([0, 11.3], [count - 0.3] * 2, color=style.BLACK, linewidth=0.8)
    for row, variant in enumerate(VARIANTS.values()):
        y, family = count - 0.9 - row, style.family(variant.family)
        ax.plot([0.12], [y], **family | {"linestyle": ""}, markersize=5)
        for (x, _), text in zip(COLUMNS, (variant.label, *cells(variant.composition)), strict=True):
            ax.text(x + 0.3 * (x == 0), y, text, fontsize=8, verticalalignment="center")
        ax.plot([0, 11.3], [y - 0.5] * 2, color=style.GREY, linewidth=0.3)
    return figure
