"""Engines of others as solvers from outside, each by one function; frame.py has what they share. `experiments/solvers/install` fetches them.

    conelane solve --solver "exec:scip=build/solvers/bin/python experiments/adapters/engines.py scip" ...

An engine stays running. `engines.py NAME {mps} {sol} {limit_s} {gap} {threads} {seed}` answers one program and ends. Engines have their
default settings but for limits, gap, threads and seed."""

import math
import os
import re
import sys

from frame import Answer, serve

SEEDS = 2**31 - 1


def point(names, values):
    return dict(zip(names, values))


def highs(ask):
    import highspy
    model = highspy.Highs()
    model.silent()
    model.readModel(ask.program)
    for option, value in (("time_limit", ask.limit_s), ("mip_rel_gap", 0.0), ("mip_abs_gap", ask.gap), ("threads", ask.threads),
                          ("random_seed", ask.seed % SEEDS)):
        model.setOptionValue(option, value)
    if ask.cutoff is not None:
        model.setOptionValue("objective_bound", ask.cutoff)
    ask.clock(model.run)
    status, info = model.getModelStatus(), model.getInfo()
    is_none = status in (highspy.HighsModelStatus.kInfeasible, highspy.HighsModelStatus.kUnboundedOrInfeasible, highspy.HighsModelStatus.kObjectiveBound)
    claim = "optimal" if status == highspy.HighsModelStatus.kOptimal else "infeasible" if is_none else "stopped"
    has_point = info.primal_solution_status == highspy.SolutionStatus.kSolutionStatusFeasible
    values = point(model.getLp().col_names_, model.getSolution().col_value) if has_point else None
    return Answer(claim, values, info.mip_dual_bound, info.mip_node_count, f"HiGHS {model.version()}")


def cycles(edges):
    """The cone sets of the cycles among edges, pairs of cones of which no cone has more than two."""
    parent = {}

    def root(cone):
        while parent.setdefault(cone, cone) != cone:
            cone = parent[cone]
        return cone
    closed = []
    for i, j in edges:
        if root(i) == root(j):
            closed.append(i)
        parent[root(i)] = root(j)
    return [{cone for cone in parent if root(cone) == root(one)} for one in closed]


def scip(ask):
    """Rows (5) on demand, by a constraint handler within the search; those of the pairing by conelane's rounds. A program with all rows
    has no cycles, so the handler is left out."""
    import pyscipopt
    model = pyscipopt.Model()
    model.hideOutput()
    model.readProblem(ask.program)
    edge = {tuple(map(int, variable.name.split("_")[1:])): variable for variable in model.getVars() if variable.name.startswith("a_")}
    feasible, infeasible = {"result": pyscipopt.SCIP_RESULT.FEASIBLE}, {"result": pyscipopt.SCIP_RESULT.INFEASIBLE}

    class NoCycles(pyscipopt.Conshdlr):
        def found(self, solution):
            return cycles([pair for pair, variable in edge.items() if self.model.getSolVal(solution, variable) > 0.5])

        def conscheck(self, constraints, solution, *_, **__):
            return infeasible if self.found(solution) else feasible

        def consenfolp(self, *_):
            closed = self.found(None)
            for cones in closed:
                inside = pyscipopt.quicksum(variable for (i, j), variable in edge.items() if i in cones and j in cones)
                self.model.addCons(inside <= len(cones) - 1)
            return {"result": pyscipopt.SCIP_RESULT.CONSADDED} if closed else feasible

        consenfops = consenfolp

        def conslock(self, constraint, locktype, nlockspos, nlocksneg):
            for variable in edge.values():
                self.model.addVarLocksType(variable, locktype, nlocksneg, nlockspos)

    lazily = not any(variable.name.startswith("y_") for variable in model.getVars())
    if lazily:
        model.includeConshdlr(NoCycles(), "no-cycles", "the rows (5)", enfopriority=-10, chckpriority=-10, needscons=False)
    model.setParams({"limits/time": ask.limit_s, "limits/gap": 0.0, "limits/absgap": ask.gap, "randomization/randomseedshift": ask.seed % SEEDS,
                     "misc/allowstrongdualreds": not lazily, "misc/allowweakdualreds": not lazily})
    if ask.cutoff is not None:
        model.setObjlimit(ask.cutoff)
    ask.clock(model.optimize)
    values = {variable.name: model.getVal(variable) for variable in model.getVars()} if model.getNSols() else None
    return Answer({"inforunbd": "infeasible"}.get(model.getStatus(), model.getStatus()), values, model.getDualbound(), model.getNTotalNodes(),
                  f"SCIP {model.getMajorVersion()}.{model.getMinorVersion()}.{model.getTechVersion()}")


def cp_sat(ask):
    """Columns that need not be integer are halves in some optimum: the flow of a lane graph is, and turns and cones follow its edges. Costs
    are scaled to integers; the bound allows for what rounding them can make."""
    import ortools
    from ortools.sat.python import cp_model
    program, model = ask.read(), cp_model.CpModel()
    unit = {name: 1 if name in program.integer else 2 for name in program.cost}
    column = {name: model.new_int_var(math.ceil(low * unit[name]), math.floor(high * unit[name]), name) for name, (low, high) in program.bounds.items()}
    for row, (low, high) in program.rows.items():
        weights = {name: 4 * value / unit[name] for name, value in program.entries[row]}
        if any(weight != int(weight) for weight in weights.values()):
            raise ValueError(f"a coefficient of row {row} is no multiple of 1/2")
        low, high = (cp_model.INT_MIN if low == -math.inf else math.ceil(4 * low), cp_model.INT_MAX if high == math.inf else math.floor(4 * high))
        model.add_linear_constraint(sum(int(weight) * column[name] for name, weight in weights.items()), low, high)
    ranges = {name: (high - low) * unit[name] for name, (low, high) in program.bounds.items()}
    most = sum(abs(cost) * ranges[name] / unit[name] for name, cost in program.cost.items())
    scale = 2.0 ** (50 - max(0, math.frexp(most)[1]))
    error = 0.5 * sum(ranges[name] for name, cost in program.cost.items() if cost) / scale
    total = sum(round(cost * scale / unit[name]) * column[name] for name, cost in program.cost.items())
    model.minimize(total)
    if ask.cutoff is not None:
        model.add(total <= math.floor((ask.cutoff + error) * scale))
    solver = cp_model.CpSolver()
    settings = solver.parameters
    settings.max_time_in_seconds, settings.num_workers, settings.random_seed = ask.limit_s, ask.threads, ask.seed % SEEDS
    settings.absolute_gap_limit = settings.relative_gap_limit = 0.0
    status = ask.clock(solver.solve, model)
    has_point = status in (cp_model.OPTIMAL, cp_model.FEASIBLE)
    values = {name: solver.value(variable) / unit[name] for name, variable in column.items()} if has_point else None
    bound = solver.best_objective_bound / scale - error if has_point else None  # it says 0 before it knows one
    return Answer(solver.status_name(status).lower(), values, bound, solver.num_branches, f"CP-SAT {ortools.__version__}")


def gurobi(ask):
    import gurobipy
    with gurobipy.Env(params={"OutputFlag": 0}) as env, gurobipy.read(ask.program, env) as model:
        model.Params.TimeLimit, model.Params.MIPGap, model.Params.MIPGapAbs = ask.limit_s, 0.0, ask.gap
        model.Params.Threads, model.Params.Seed = ask.threads, ask.seed % SEEDS
        if ask.cutoff is not None:
            model.Params.Cutoff = ask.cutoff
        ask.clock(model.optimize)
        status = gurobipy.GRB.Status
        claim = {status.OPTIMAL: "optimal", status.INFEASIBLE: "infeasible", status.INF_OR_UNBD: "infeasible", status.CUTOFF: "infeasible"}
        values = point(model.getAttr("VarName", model.getVars()), model.getAttr("X", model.getVars())) if model.SolCount else None
        return Answer(claim.get(model.Status, "stopped"), values, model.ObjBound, model.NodeCount, "Gurobi " + ".".join(map(str, gurobipy.gurobi.version())))


def xpress(ask):
    import xpress as library
    problem = library.problem()
    problem.controls.outputlog = 0
    problem.readProb(ask.program)
    controls = problem.controls
    controls.timelimit, controls.miprelstop, controls.mipabsstop, controls.threads = ask.limit_s, 0.0, ask.gap, ask.threads
    controls.randomseed = ask.seed % SEEDS
    if ask.cutoff is not None:
        controls.mipabscutoff = ask.cutoff
    ask.clock(problem.optimize)
    status, attributes = problem.attributes.solstatus, problem.attributes
    claim = {library.SolStatus.OPTIMAL: "optimal", library.SolStatus.INFEASIBLE: "infeasible"}.get(status, "stopped")
    values = {one.name: value for one, value in zip(problem.getVariable(), problem.getSolution())} if attributes.mipsols else None
    return Answer(claim, values, attributes.bestbound, attributes.nodes, f"Xpress {library.__version__}")


def cplex(ask):
    import cplex as library
    problem = library.Cplex()
    for quiet in (problem.set_log_stream, problem.set_results_stream, problem.set_warning_stream, problem.set_error_stream):
        quiet(None)
    problem.read(ask.program)
    set_to, tolerances = problem.parameters, problem.parameters.mip.tolerances
    set_to.timelimit.set(ask.limit_s)
    set_to.threads.set(ask.threads)
    set_to.randomseed.set(ask.seed % SEEDS)
    tolerances.mipgap.set(0.0)
    tolerances.absmipgap.set(ask.gap)
    if ask.cutoff is not None:
        tolerances.uppercutoff.set(ask.cutoff)
    ask.clock(problem.solve)
    said = problem.solution
    claim = {101: "optimal", 102: "optimal", 103: "infeasible", 119: "infeasible"}.get(said.get_status(), "stopped")
    values = point(problem.variables.get_names(), said.get_values()) if said.is_primal_feasible() else None
    bound = None if claim == "infeasible" else said.MIP.get_best_objective()
    return Answer(claim, values, bound, said.progress.get_num_nodes_processed(), f"CPLEX {library.__version__}")


def copt(ask):
    import coptpy
    model = coptpy.Envr().createModel()
    model.setParam("Logging", 0)
    model.readMps(ask.program)
    for name, value in (("TimeLimit", ask.limit_s), ("RelGap", 0.0), ("AbsGap", ask.gap), ("Threads", ask.threads)):
        model.setParam(name, value)
    ask.clock(model.solve)
    claim = {coptpy.COPT.OPTIMAL: "optimal", coptpy.COPT.INFEASIBLE: "infeasible"}.get(model.status, "stopped")
    values = {variable.name: variable.x for variable in model.getVars()} if model.hasmipsol else None
    version = ".".join(str(getattr(coptpy.COPT, f"VERSION_{part}")) for part in ("MAJOR", "MINOR", "TECHNICAL"))
    return Answer(claim, values, model.bestbnd, model.nodecnt, f"COPT {version}")


def mosek(ask):
    import mosek as library
    with library.Env() as env, env.Task() as task:
        task.readdata(ask.program)
        task.putintparam(library.iparam.num_threads, ask.threads)
        for name, value in ((library.dparam.mio_max_time, ask.limit_s), (library.dparam.mio_tol_rel_gap, 0.0), (library.dparam.mio_tol_abs_gap, ask.gap)):
            task.putdouparam(name, value)
        ask.clock(task.optimize)
        kind = library.soltype.itg
        status, problem = task.getsolsta(kind), task.getprosta(kind)
        has_point = status in (library.solsta.integer_optimal, library.solsta.prim_feas)
        claim = "optimal" if status == library.solsta.integer_optimal else "infeasible" if problem == library.prosta.prim_infeas else "stopped"
        values = point(map(task.getvarname, range(task.getnumvar())), task.getxx(kind)) if has_point else None
        bound = task.getdouinf(library.dinfitem.mio_obj_bound)
        return Answer(claim, values, bound, task.getintinf(library.iinfitem.mio_num_branch), "Mosek " + ".".join(map(str, library.Env.getversion())))


def number(pattern, text, kind=float):
    """The last number of a log that a pattern finds; None without one."""
    found = re.findall(pattern, text, flags=re.M)
    return kind(found[-1]) if found else None


def written(ask):
    """The lines of a program's own solution file; none if it was ended before it wrote any."""
    if not os.path.exists(ask.solution):
        return []
    with open(ask.solution, encoding="ascii") as file:
        return file.read().splitlines()


def columns_in(text, *, name, value):
    """Values by column in lines of words."""
    lines = [line.split() for line in text.splitlines()]
    return {line[name]: float(line[value]) for line in lines if len(line) > max(name, value)}


def cbc(ask):
    """The program of cbcbox, else of Debian's coinor-cbc. Its bounds have six digits; an optimum is proven to the gap that was asked for."""
    try:
        import cbcbox
        program = cbcbox.cbc_bin_path()
    except ImportError:
        program = "cbc"
    log = ask.run(program, ask.program, "-timeMode", "elapsed", "-sec", f"{ask.limit_s:.3f}", "-allow", f"{ask.gap:g}", "-ratio", "0",
                  "-increment", "1e-7", "-threads", str(ask.threads if ask.threads > 1 else 0), *(["-randomCbcSeed", str(ask.seed % SEEDS)] if ask.seed else []),
                  "-solve", "-solution", ask.solution)
    head, *lines = written(ask) or ["nothing"]
    claim = "infeasible" if "nfeasible" in head else "optimal" if head.startswith("Optimal") else "stopped"
    has_point = claim == "optimal" or (head.startswith("Stopped") and "no integer solution" not in head)
    values = columns_in("\n".join(lines).replace("**", "  "), name=1, value=2) if has_point else None
    bound = number(r"^Lower bound: +(\S+)", log) if claim == "stopped" else None
    return Answer(claim, values, bound if bound is None else bound - 1e-3 - 1e-5 * abs(bound), number(r"^Enumerated nodes: +(\d+)", log, int),
                  "CBC " + (number(r"^(?:CBC|Version:) +(\S.*?)(?: —|$)", log, str) or ""))


def glpk(ask):
    """Debian's glpk-utils, with its cuts; whole seconds only, no bound."""
    log = ask.run("glpsol", "--freemps", ask.program, "--cuts", "--tmlim", str(math.ceil(ask.limit_s)), "--mipgap", "0", "--write", ask.solution)
    lines = [line.split() for line in written(ask)]
    status = next((line[4] for line in lines if line[0] == "s"), "u")
    values = {name: float(line[2]) for name, line in zip(ask.read().cost, (line for line in lines if line[0] == "j"))}
    return Answer({"o": "optimal", "n": "infeasible"}.get(status, "stopped"), values if status in "of" else None,
                  solver="GLPK " + (number(r"GLPSOL.*? v?(\d[.\d]*)", log, str) or ""))


def symphony(ask):
    """Debian's coinor-symphony."""
    log = ask.run("symphony", "-t", f"{ask.limit_s:.3f}", "-p", "0", "-F", ask.program)
    claim = "optimal" if "Optimal Solution Found" in log else "infeasible" if "nfeasible" in log else "stopped"
    listed = log.partition("Column names and values of nonzeros")[2].partition("\n\n")[0]
    values = columns_in("\n".join(line for line in listed.splitlines() if re.match(r"[a-z]\S* +\S+ *$", line)), name=0, value=1)
    return Answer(claim, values or None, number(r"^Current Lower Bound: +(\S+)", log), number(r"^Number of analyzed nodes: +(\d+)", log, int),
                  "SYMPHONY " + (number(r"Version: +(\S+)", log, str) or ""))


def lp_solve(ask):
    """Debian's lp-solve; whole seconds only, no bound."""
    version = number(r"version (\S+):", ask.run("lp_solve", "-p", "parse"), str)
    ask.ms = 0.0
    log = ask.run("lp_solve", "-fmps", ask.program, "-timeout", str(math.ceil(ask.limit_s)), "-S4")
    is_proven = "Value of objective function" in log and not re.search("sub-?optimal", log, flags=re.I)
    claim = "infeasible" if "problem is infeasible" in log else "optimal" if is_proven else "stopped"
    listed = (log + "\n").partition("Actual values of the variables:")[2].partition("Actual values of the constraints")[0]
    return Answer(claim, columns_in(listed, name=0, value=1) or None, solver=f"lp_solve {version}")


# The function, and the package or program that it needs.
ENGINES = {"highspy": (highs, ["highspy"]), "scip": (scip, ["pyscipopt"]), "cp-sat": (cp_sat, ["ortools"]),
           "cbc-today": (cbc, ["cbcbox", "cbc"]), "glpsol": (glpk, ["glpsol"]), "symphony": (symphony, ["symphony"]), "lp-solve": (lp_solve, ["lp_solve"]),
           "gurobi": (gurobi, ["gurobipy"]), "xpress": (xpress, ["xpress"]), "cplex": (cplex, ["cplex"]), "copt": (copt, ["coptpy"]),
           "mosek": (mosek, ["mosek"])}

if __name__ == "__main__":
    serve(ENGINES, sys.argv[1:])
