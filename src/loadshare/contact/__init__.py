"""Contact problems without any gear: laws, radial graphs, arcs; programmes, and what solves them.

A :class:`~loadshare.contact.problem.ContactProblem` is a set of springs, loads and contacts. A
:class:`~loadshare.contact.plan.Plan` says which contacts are in play, a
:class:`~loadshare.contact.programme.Programme` is what a solver sees, and
:func:`~loadshare.contact.outer.settle` goes from one to the next until laws and faces agree.
"""
