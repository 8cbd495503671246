"""What kind of noise is this? Normality, whiteness and Allan deviation of a series, as one tidy table.

The tests themselves are those of scipy, statsmodels and allantools; this floor chooses their inputs, states what each
assumes and puts the answers side by side. `robins.diagnostics.summary.diagnose` runs them all, and
`robins.diagnostics.pictures.pictures` computes the arrays that a figure of the same series needs.
"""
