"""Flights through a medium: distances are drawn without derivatives, and weighted with them.

By channel λ, with the optical depth τ and the extinction σ_t:

    transmittance     T_λ(t) = exp(-τ_λ(t))
    collisions        g_λ(t) = σ_t,λ(t) T_λ(t), per length; its integral is 1 - T_λ(end)

A flight that is known to end at a surface, or to leave the medium, collides with the chance c,
at a distance drawn from the channel k with the chance q_k (1 - T_k) / Σ_j q_j (1 - T_j), where q
is in proportion to the throughput. So what a collision brings has the weight

    g_λ(t) Σ_j q_j (1 - T_j) / (c Σ_k q_k g_k(t)),   and the end    T_λ(end) / (1 - c)

which is the balance heuristic over the channels.
"""

import drjit as dr
import mitsuba as mi

TINY = 1e-30


def each(mask, a, b):
    """dr.select by channel: it would forget that the result is a spectrum."""
    return mi.Spectrum(dr.select(mask, a, b))


def channel_chances(throughput):
    """The probabilities of channels: in proportion to the throughput."""
    weight = dr.maximum(throughput, 0)
    total = dr.sum(weight)
    return each(total > 0, weight / total, 1 / len(weight))


def choose(chances, u):
    """The channel that a uniform variate chooses."""
    channel, below = mi.UInt32(0), mi.Float(0)
    for i in range(len(chances) - 1):
        below += chances[i]
        channel = dr.select(u >= below, i + 1, channel)
    return channel


def pick(values, channel):
    """The value of a channel."""
    value = values[0]
    for i in range(1, len(values)):
        value = dr.select(channel == i, values[i], value)
    return value


def opacity(depth):
    """1 - exp(-depth), as precise for thin media."""
    half = dr.tanh(dr.minimum(0.5 * depth, 44))
    return 2 * half / (1 + half)


def first_collision(place, columns, o, d, length, channel, lost, variates):
    """Distance of the collision of a flight that has one, of the probability `lost`.

    And the columns up to there, if they are known: that of a single component.

    The components stand one behind the other: the optical depth at which the flight ends lies in
    one of them, which it has met then. Those before it have been passed; those behind it may
    collide earlier, each independently.
    """
    t, wanted = mi.Float(dr.inf), mi.Float(0)
    rest = -dr.log(1 - variates[0] * lost)
    met = mi.Bool(False)
    parts = zip(place.profiles, place.sigma_t, columns, variates, strict=True)
    for i, (profile, sigma, column, u) in enumerate(parts):
        sigma_t = pick(sigma, channel)
        depth = sigma_t * column
        meets = ~met & (rest < depth)
        own = dr.select(met, -dr.log(1 - u), rest) if i > 0 else rest
        collides = (own < depth) & (met | meets)
        wanted = dr.select(collides, own / dr.maximum(sigma_t, TINY), 0)
        distance = dr.minimum(profile.inv_reached_column(o, d, wanted), length)
        t = dr.minimum(t, dr.select(collides, distance, dr.inf))
        met |= meets
        rest = dr.maximum(rest - depth, 0)
    return t, [wanted] if len(columns) == 1 else None


def collision_weight(chances, natural, chance, depth, extinction):
    """g_λ(t) over the density of the collision, from the optical depth and the extinction there.

    In logarithms up to a common factor, so that nothing that matters underflows.
    """
    least = dr.min(dr.select(chances > 0, depth, dr.inf))
    density = dr.exp(-dr.maximum(depth - least, 0)) * extinction
    pdf = dr.sum(chances * density)
    return each(pdf > 0, density / pdf, 0) * natural / dr.maximum(chance, TINY)
